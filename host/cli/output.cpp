#include "cli/output.h"

#include <fmt/format.h>

#include <cctype>
#include <cerrno>
#include <cstdio>
#include <cstring>

#include "base/error.h"
#include "base/write_file.h"

namespace fs = std::filesystem;

namespace kdray::cli {

void check_text_output(const fs::path& file) {
  if (file != "-") check_writable(file);
}

void write_text(const fs::path& file, std::string_view text) {
  if (file == "-") return print(text);
  write_file(file, text);
}

void print(std::string_view text) {
  const bool whole = std::fwrite(text.data(), 1, text.size(), stdout) == text.size();
  if (!whole || std::fflush(stdout) != 0)
    throw input_error("standard output", 0, fmt::format("can't be written ({})", std::strerror(errno)));
}

void check_apart(std::string_view option_a, const fs::path& a, std::string_view option_b, const fs::path& b) {
  if (a.empty() || b.empty()) return;
  std::error_code error;
  const bool same_name = fs::absolute(a).lexically_normal() == fs::absolute(b).lexically_normal();
  const bool same_file = fs::equivalent(a, b, error) && fs::is_regular_file(a, error);
  if (same_file || (same_name && !fs::is_other(a, error)))
    throw Error(ErrorCode::usage, fmt::format("{} and {} are the same file, {}; give them different names",
                                              option_a, option_b, a.string()));
}

std::string ending_of(const fs::path& file) {
  std::string ending = file.extension().string();
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return ending;
}

fs::path default_picture(const fs::path& scene) {
  fs::path name = scene.filename();
  if (const std::string ending = ending_of(name); ending == ".gz" || ending == ".xz") name = name.stem();
  return name.replace_extension(".png");
}

}  // namespace kdray::cli
