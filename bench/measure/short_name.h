// What    A scene's name in tables and plots.
#pragma once

#include <filesystem>
#include <string>

namespace kdray::bench {

// "balls" of ".../balls.nff.gz".
inline std::string short_name(const std::string& name_or_file) {
  const std::string file = std::filesystem::path(name_or_file).filename().string();
  return file.substr(0, file.find('.'));
}

}  // namespace kdray::bench
