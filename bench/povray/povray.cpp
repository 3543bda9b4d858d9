#include "bench/povray/povray.h"

#include <fmt/format.h>

#include <charconv>
#include <fstream>
#include <iterator>
#include <vector>

#include "base/error.h"
#include "bench/measure/run_program.h"
#include "io/image/picture_file.h"

namespace kdray::bench {

namespace {

std::string text_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::string last_line(const std::string& text) {
  const std::size_t end = text.find_last_not_of(" \r\n");
  if (end == std::string::npos) return "it said nothing";
  const std::size_t start = text.find_last_of('\n', end);
  return text.substr(start == std::string::npos ? 0 : start + 1, end - start);
}

std::unique_ptr<Temporary> new_folder() {
  std::unique_ptr<Temporary> folder = make_temporary_folder("kdray-bench-");
  if (!folder)
    throw Error(ErrorCode::input, "a temporary folder can't be made; set TMPDIR to one that can be written");
  return folder;
}

}  // namespace

bool has_povray() {
  static const bool there = run_program({"povray", "--version"}, "/dev/null") == 0;
  return there;
}

// "Trace Time:   0 hours  0 minutes  1 seconds (1.350 seconds)"
double trace_time_in(const std::string& output) {
  const std::size_t line = output.find("Trace Time:");
  const std::size_t bracket = line == std::string::npos ? line : output.find('(', line);
  if (bracket == std::string::npos || bracket > output.find('\n', line)) return -1;
  double seconds = -1;
  std::from_chars(output.data() + bracket + 1, output.data() + output.size(), seconds);
  return seconds;
}

Povray::Povray(const scene::Scene& scene, int width, int height, int depth, double min_weight)
    : temporary_(new_folder()), folder_(temporary_->path()), width_(width), height_(height) {
  std::ofstream out(folder_ / "scene.pov");
  write_pov(out, scene, static_cast<double>(width) / height, depth, min_weight);
  out.close();
  if (!out) throw input_error((folder_ / "scene.pov").string(), 0, "can't be written", "is the disk full?");
}

double Povray::trace_seconds(int threads) const {
  return run_with(threads, {"-A", "-F"});
}

// The picture is an EXR: a PNG would cut off what is brighter than white, before anyone can take a mean.
Povray::Traced Povray::trace(int threads, const std::vector<std::string>& flags) const {
  const std::filesystem::path file = folder_ / "picture.exr";
  std::vector<std::string> all = flags;
  all.insert(all.end(), {"+FE", "+O" + file.string()});
  const double seconds = run_with(threads, all);
  return {seconds, image::read_picture(file, {})};
}

double Povray::run_with(int threads, const std::vector<std::string>& flags) const {
  const std::filesystem::path log = folder_ / "log";
  std::vector<std::string> arguments = {"povray",
                                        "+I" + (folder_ / "scene.pov").string(),
                                        fmt::format("+W{}", width_),
                                        fmt::format("+H{}", height_),
                                        "-D",
                                        fmt::format("+WT{}", threads)};
  arguments.insert(arguments.end(), flags.begin(), flags.end());
  const int code = run_program(arguments, log);
  const std::string output = text_of(log);
  const double seconds = trace_time_in(output);
  if (code != 0 || seconds < 0) throw Error(ErrorCode::internal, "povray failed: " + last_line(output));
  return seconds;
}

}  // namespace kdray::bench
