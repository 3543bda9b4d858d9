// What    A picture on its way to a page, in one message: four bytes with the length of a JSON text (little
//         endian), the text, the picture's file.
#pragma once

#include <memory>
#include <string>
#include <string_view>

namespace kdray::view {

using Bytes = std::shared_ptr<const std::string>;

Bytes make_frame(std::string_view head, std::string_view picture);

}  // namespace kdray::view
