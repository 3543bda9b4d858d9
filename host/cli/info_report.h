// What    The parts of what `kdray info` prints, as JSON, and that JSON as text for people: one source
//         of figures for both.
#pragma once

#include <string>

#include "cli/stats.h"
#include "kdtree/statistics.h"
#include "kdtree/tree.h"
#include "scene/geometry.h"
#include "scene/scene.h"

namespace kdray::cli {

Json scene_report(const scene::Scene& scene, const scene::Geometry& geometry);
Json tree_report(const kdtree::Tree& tree, const kdtree::Statistics& statistics);
Json memory_report(const scene::Scene& scene, const scene::Geometry& geometry, const kdtree::Tree& tree);

std::string report_as_text(const Json& report);

}  // namespace kdray::cli
