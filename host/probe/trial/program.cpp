#include "probe/trial/program.h"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <string_view>
#include <system_error>

namespace kdray::trial {

namespace fs = std::filesystem;

namespace {

std::atomic<bool> tries_itself{false};

constexpr const char* kName = "kdray";

bool can_be_run(const fs::path& program) {
  std::error_code error;
  return fs::is_regular_file(program, error) && ::access(program.c_str(), X_OK) == 0;
}

fs::path beside_this_program() {
  std::error_code error;
  const fs::path own = fs::read_symlink("/proc/self/exe", error);
  return own.empty() ? own : own.parent_path() / kName;
}

std::optional<fs::path> in_path() {
  const char* const set = std::getenv("PATH");
  std::string_view rest = set ? set : "";
  while (!rest.empty()) {
    const std::string_view folder = rest.substr(0, rest.find(':'));
    rest.remove_prefix(std::min(folder.size() + 1, rest.size()));
    const fs::path program = fs::path(folder) / kName;
    if (program.is_absolute() && can_be_run(program)) return program;
  }
  return std::nullopt;
}

}  // namespace

void this_program_tries() {
  tries_itself = true;
}

// By this link even a program is found that an upgrade has replaced meanwhile.
std::optional<fs::path> program() {
  if (tries_itself) return "/proc/self/exe";
  if (const char* const set = std::getenv("KDRAY_PROGRAM"); set && *set)
    return can_be_run(set) ? std::optional<fs::path>(set) : std::nullopt;
  for (const fs::path& program : {beside_this_program(), fs::path(KDRAY_INSTALLED_PROGRAM)})
    if (can_be_run(program)) return program;
  return in_path();
}

}  // namespace kdray::trial
