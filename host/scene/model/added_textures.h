// What    Pictures that a program lays onto its meshes: its pixels or files as pictures, its materials with
//         their maps, and how both come to an assembled scene.
// Errors  kdray::Error, ErrorCode::input or usage, in one line that names the argument.
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "kdray/model.h"
#include "scene/model/added_geometry.h"
#include "scene/textures/texturing.h"

namespace kdray::scene {

std::shared_ptr<const Picture> picture_of(const Pixels& pixels);
std::shared_ptr<const Picture> picture_of(const std::filesystem::path& file,
                                          std::vector<std::string>& warnings);

// The material in Whitted's terms; one with pictures gets maps in `texturing`, whose pictures its numbers
// mean.
Material textured_material(const kdray::Material& material, Texturing& texturing);

// Brings that texturing, and the meshes' coordinates, to a scene which `geometries` and the `n_materials`
// last of its materials were just put into.
void assemble_textures(Scene& scene, std::span<const AddedGeometry* const> geometries,
                       const Texturing& texturing, std::size_t n_materials);

}  // namespace kdray::scene
