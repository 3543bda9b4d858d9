#include "apps/cli/start_bench.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <string_view>

#include "base/signals.h"
#include "kdray/error.h"

namespace kdray::cli {

namespace {

constexpr const char* kProgram = "kdray-bench";

// The running program itself, whatever link or search path it was started by.
std::filesystem::path own_path() {
  std::error_code none;  // without /proc: the folder that kdray is run in
  return std::filesystem::read_symlink("/proc/self/exe", none);
}

}  // namespace

Command add_bench(CLI::App& kdray) {
  CLI::App* const app =
      kdray.add_subcommand("bench", "Measure rays or frames, beside Embree and POV-Ray where they are");
  return {app, [app]() -> int { start_bench(app->remaining()); }};
}

std::optional<std::vector<std::string>> arguments_of_bench(std::span<const char* const> arguments) {
  const auto is = [&](std::size_t i, std::string_view word) {
    return i < arguments.size() && arguments[i] == word;
  };
  if (is(1, "bench")) return std::vector<std::string>(arguments.begin() + 2, arguments.end());
  if ((is(1, "--help") || is(1, "-h")) && is(2, "bench")) {
    std::vector<std::string> more(arguments.begin() + 3, arguments.end());
    more.emplace_back("--help");
    return more;
  }
  return {};
}

void start_bench(const std::vector<std::string>& arguments) {
  const std::filesystem::path program = own_path().replace_filename(kProgram);
  std::vector<char*> argv = {const_cast<char*>(kProgram)};
  for (const std::string& a : arguments) argv.push_back(const_cast<char*>(a.c_str()));
  argv.push_back(nullptr);
  leave_signals_alone();
  ::execv(program.c_str(), argv.data());
  if (errno == ENOENT)
    throw input_error(program.string(), 0, "no such file: this kdray comes without the program that measures",
                      "install it, or build it (target kdray_bench_program), and put it beside kdray");
  throw input_error(program.string(), 0, std::string("can't be run: ") + std::strerror(errno),
                    "install it anew beside kdray");
}

}  // namespace kdray::cli
