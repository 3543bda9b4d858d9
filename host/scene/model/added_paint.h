// What    Pictures that a program lays onto its meshes: its pixels or files as pictures, its materials as
//         coats, and how both come to an assembled scene.
// Errors  kdray::Error, ErrorCode::input or usage, in one line that names the argument.
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "kdray/model.h"
#include "scene/model/added_geometry.h"
#include "scene/textures/paint.h"

namespace kdray::scene {

std::shared_ptr<const Picture> picture_of(const Pixels& pixels);
std::shared_ptr<const Picture> picture_of(const std::filesystem::path& file,
                                          std::vector<std::string>& warnings);

// The material in Whitted's terms; one with pictures gets a coat in `paint`, whose pictures its numbers mean.
Material painted_material(const kdray::Material& material, Paint& paint);

// Brings that paint, and the meshes' coordinates, to a scene which `geometries` and the `n_materials` last of
// its materials were just put into.
void assemble_paint(Scene& scene, std::span<const AddedGeometry* const> geometries, const Paint& paint,
                    std::size_t n_materials);

}  // namespace kdray::scene
