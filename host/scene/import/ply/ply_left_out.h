// What    Which elements and properties of a PLY file's header nothing is made of, by name and number.
#pragma once

#include <string>
#include <vector>

#include "scene/import/ply/ply_header.h"

namespace kdray::scene::ply {

std::vector<std::string> left_out_of(const Header& header, const std::string& file);

}  // namespace kdray::scene::ply
