// What    The files of the page that the server shows, as they lie in host/apps/view/page: embedded, so that
//         nothing is read, and nobody asked, at run time.
#pragma once

#include <span>
#include <string_view>

namespace kdray::view {

struct PageFile {
  std::string_view path;  // "/main.js"
  std::string_view text;
};

std::span<const PageFile> page_files();

}  // namespace kdray::view
