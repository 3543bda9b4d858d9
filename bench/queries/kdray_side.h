// What    kdray as a side of `bench queries`: by way of its public interface.
// Errors  Those of kdray/scene.h.
#pragma once

#include <memory>

#include "bench/race/asker.h"
#include "kdray/kdray.h"

namespace kdray::bench {

// The mesh as a scene that has been committed.
Scene kdray_scene(const MeshArrays& mesh, const DeviceOptions& device,
                  VertexPrecision geometry = VertexPrecision::float32);

// The mesh has to outlive it.
Side kdray_side(const std::shared_ptr<const Scene>& scene, const MeshArrays& mesh,
                const DeviceOptions& device);

// The same with vertices, rays and answers in doubles (TreeOptions::geometry).
Side double_side(const MeshArrays& mesh, const DeviceOptions& device);

}  // namespace kdray::bench
