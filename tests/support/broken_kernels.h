// What    The kernels in a folder of their own, with one place of a file changed: for KDRAY_KERNEL_DIR, to
//         play a device that computes wrongly.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "kernels.h"
#include "support/folder.h"

namespace kdray::test {

inline void put_kernels(const Folder& folder, const std::string& file, const std::string& place,
                        const std::string& changed) {
  for (const kernels::Source& source : kernels::sources()) {
    std::string text(source.text);
    if (source.name == file) {
      const std::size_t at = text.find(place);
      ASSERT_NE(at, std::string::npos) << place;
      text.replace(at, place.size(), changed);
    }
    std::filesystem::create_directories((folder / std::string(source.name)).parent_path());
    folder.put(std::string(source.name), text);
  }
}

}  // namespace kdray::test
