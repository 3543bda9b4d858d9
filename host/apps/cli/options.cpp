#include "apps/cli/options.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <string_view>

#include "accel/prepare/prepared.h"
#include "apps/cli/help.h"
#include "base/error.h"
#include "base/text.h"
#include "device/tuning/database.h"
#include "io/image/color.h"
#include "kdray/kdray.h"

namespace kdray::cli {

namespace {

// Reads the whole of `text` as a number: "1e3 " or "5x" are none, and neither are "inf" and "nan".
template <class T>
bool whole_number(std::string_view text, T& value) {
  const char* const end = text.data() + text.size();
  const auto [stopped, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || stopped != end) return false;
  if constexpr (std::is_floating_point_v<T>) return std::isfinite(value);
  return true;
}

// In the order of the enumerations' values.
constexpr std::array<std::string_view, 5> kTraversals = {"auto", "binary", "wide", "packet", "batch"};
constexpr std::array<std::string_view, 3> kSchedules = {"auto", "slices", "global"};
constexpr std::array<std::string_view, 2> kPrecisions = {"float", "double"}, kFormats = {"png", "exr"};

// "; did you mean 'depth'?", or nothing.
std::string guess(std::string_view word, std::span<const std::string_view> accepted) {
  const std::string meant = did_you_mean(word, accepted);
  return meant.empty() ? "" : "; " + meant;
}

// "-o,--output" -> "--output", for messages.
std::string long_name(const std::string& name) {
  return name.substr(name.find("--"));
}

}  // namespace

Error usage_error(std::string_view option, std::string_view given, std::string_view wanted) {
  return Error(ErrorCode::usage, fmt::format("{} '{}': expected {}", option, given, wanted));
}

int parse_int(std::string_view option, std::string_view text, int lo, int hi) {
  int value = 0;
  if (!whole_number(text, value) || value < lo || value > hi)
    throw usage_error(option, text, fmt::format("a whole number from {} to {}", lo, hi));
  return value;
}

double parse_real(std::string_view option, std::string_view text, double lo, double hi) {
  double value = 0;
  if (!whole_number(text, value) || value < lo || value > hi)
    throw usage_error(option, text, fmt::format("a number from {} to {}", lo, hi));
  return value;
}

std::vector<double> parse_numbers(std::string_view text) {
  std::vector<double> numbers;
  for (const std::string& part : split_list(text)) {
    double value = 0;
    if (!whole_number(part, value)) return {};
    numbers.push_back(value);
  }
  return numbers;
}

// The number is exact where it is whole; a fraction is rounded down to a byte.
std::uint64_t parse_bytes(std::string_view option, std::string_view text) {
  constexpr std::string_view kUnits = "KMGT", kLowerUnits = "kmgt";
  constexpr std::string_view kWanted = "a number of bytes, as in 4096, 64K, 500M, 1.5G or 1T";
  constexpr double kTooMany = 18446744073709551616.0;  // 2^64
  const auto unit = text.empty() ? std::string_view::npos
                                 : std::min(kUnits.find(text.back()), kLowerUnits.find(text.back()));
  const bool has_unit = unit != std::string_view::npos;
  const unsigned shift = has_unit ? 10 * (static_cast<unsigned>(unit) + 1) : 0;
  const std::string_view number = text.substr(0, text.size() - (has_unit ? 1 : 0));
  if (number.empty() || number.find_first_not_of("0123456789.") != std::string_view::npos)
    throw usage_error(option, text, kWanted);
  std::uint64_t whole = 0;
  if (whole_number(number, whole) && whole <= std::numeric_limits<std::uint64_t>::max() >> shift)
    return whole << shift;
  double value = 0;
  if (!whole_number(number, value)) throw usage_error(option, text, kWanted);
  value = std::ldexp(value, static_cast<int>(shift));
  if (value >= kTooMany) throw usage_error(option, text, "less than 2^64 bytes, as in 500M, 1.5G or 1T");
  return static_cast<std::uint64_t>(value);
}

Size parse_size(std::string_view option, std::string_view text, int side_max, long long pixels_max) {
  Size size;
  const std::size_t cross = text.find_first_of("xX");
  const bool is_one = cross == std::string_view::npos;
  const bool good = whole_number(text.substr(0, cross), size.width) &&
                    whole_number(is_one ? text : text.substr(cross + 1), size.height) && size.width >= 1 &&
                    size.height >= 1 && size.width <= side_max && size.height <= side_max;
  if (!good)
    throw usage_error(option, text, fmt::format("WIDTHxHEIGHT or WIDTH, each from 1 to {}", side_max));
  if (static_cast<long long>(size.width) * size.height > pixels_max)
    throw usage_error(option, text, fmt::format("no more than {} pixels in all", pixels_max));
  return size;
}

PixelRect parse_crop(std::string_view option, std::string_view text) {
  PixelRect part;
  const std::size_t x = text.find_first_of("xX"), first = text.find('+'), second = text.rfind('+');
  const bool good = x < first && first < second && second != std::string_view::npos &&
                    whole_number(text.substr(0, x), part.width) &&
                    whole_number(text.substr(x + 1, first - x - 1), part.height) &&
                    whole_number(text.substr(first + 1, second - first - 1), part.x) &&
                    whole_number(text.substr(second + 1), part.y) && part.width >= 1 && part.height >= 1 &&
                    part.x >= 0 && part.y >= 0;
  if (!good)
    throw usage_error(option, text,
                      "WIDTHxHEIGHT+X+Y in pixels, from the picture's top left, as in 200x100+30+40");
  return part;
}

Samples parse_samples(std::string_view option, std::string_view text) {
  constexpr std::string_view kAdaptive = "adaptive";
  constexpr int kMost = 65536;
  constexpr double kLeast = 1e-6, kLargest = 1e6;
  Samples samples;
  if (text == kAdaptive) return {0, kDefaultAdaptiveTarget};
  if (text.starts_with("adaptive:") && whole_number(text.substr(kAdaptive.size() + 1), samples.target) &&
      samples.target >= kLeast && samples.target <= kLargest)
    return samples;
  if (whole_number(text, samples.number) && samples.number >= 1 && samples.number <= kMost)
    return {samples.number, 0};
  throw usage_error(
      option, text,
      fmt::format("a whole number from 1 to {}, adaptive, or adaptive:TARGET with an RMSE of {} or more",
                  kMost, kLeast));
}

image::Transfer parse_gamma(std::string_view option, std::string_view text) {
  if (text == "srgb") return {};
  double gamma = 0;
  if (!whole_number(text, gamma) || gamma < 0.1 || gamma > 10)
    throw usage_error(option, text, "srgb or a number from 0.1 to 10");
  return {.srgb = false, .gamma = gamma};
}

std::size_t parse_choice(std::string_view option, std::string_view text,
                         std::span<const std::string_view> accepted) {
  const auto found = std::find(accepted.begin(), accepted.end(), text);
  if (found == accepted.end())
    throw usage_error(option, text,
                      fmt::format("{}{}{}", accepted.size() > 1 ? "one of " : "", fmt::join(accepted, ", "),
                                  guess(text, accepted)));
  return static_cast<std::size_t>(found - accepted.begin());
}

std::vector<std::string> parse_list(std::string_view option, std::string_view text,
                                    std::span<const std::string_view> accepted) {
  std::vector<std::string> names;
  for (const std::string& name : split_list(text)) {
    if (std::find(accepted.begin(), accepted.end(), name) == accepted.end())
      throw usage_error(option, text,
                        fmt::format("names from {}, with commas between{}", fmt::join(accepted, ", "),
                                    guess(name, accepted)));
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  }
  return names;
}

Color parse_color(std::string_view option, std::string_view text, std::string_view others) {
  if (const auto named = image::css_color(text)) return {named->x, named->y, named->z};
  constexpr double kMost = 1e6;
  const std::vector<double> numbers = parse_numbers(text);
  const auto is_good = [](double x) { return x >= 0 && x <= kMost; };
  if (numbers.size() != 3 || !std::ranges::all_of(numbers, is_good))
    throw usage_error(
        option, text,
        fmt::format("{}a colour's name as CSS has it, #rgb, #rrggbb, or R,G,B in linear values, "
                    "each from 0{}",
                    others, guess(text, image::css_names())));
  return {static_cast<float>(numbers[0]), static_cast<float>(numbers[1]), static_cast<float>(numbers[2])};
}

CLI::Option* add_text(CLI::App& app, const std::string& name, const std::string& shape,
                      const std::string& help, std::function<void(const std::string&)> take) {
  // Of an option that is given twice the last one counts, so that scripts may add theirs.
  return app.add_option_function<std::string>(name, std::move(take), help)->type_name(shape)->take_last();
}

std::string shape_of(std::span<const std::string_view> names) {
  return fmt::format("{}", fmt::join(names, "|"));
}

CLI::Option* add_list(CLI::App& app, const std::string& name, const std::string& help,
                      std::span<const std::string_view> names, std::vector<std::string>& chosen) {
  return add_text(app, name, shape_of(names) + "[,...]", help,
                  [name, names, &chosen](const std::string& text) { chosen = parse_list(name, text, names); })
      ->multi_option_policy(CLI::MultiOptionPolicy::Throw);  // one might want both lists
}

CLI::Option* add_int(CLI::App& app, const std::string& name, const std::string& help, int lo, int hi,
                     int& value) {
  return add_text(app, name, "N", help, [option = long_name(name), lo, hi, &value](const std::string& text) {
    value = parse_int(option, text, lo, hi);
  });
}

CLI::Option* add_real(CLI::App& app, const std::string& name, const std::string& shape,
                      const std::string& help, double lo, double hi, double& value) {
  return add_text(app, name, shape, help,
                  [option = long_name(name), lo, hi, &value](const std::string& text) {
                    value = parse_real(option, text, lo, hi);
                  });
}

CLI::Option* add_size(CLI::App& app, const std::string& help, int side_max, long long pixels_max, int& width,
                      int& height, OneSide one_side) {
  return add_text(app, "--size", "WxH|W", help,
                  [side_max, pixels_max, &width, &height, one_side](const std::string& text) {
                    const Size size = parse_size("--size", text, side_max, pixels_max);
                    const bool follows =
                        one_side == OneSide::by_aspect && text.find_first_of("xX") == std::string::npos;
                    width = size.width, height = follows ? 0 : size.height;
                  });
}

// What stands for standard output besides "-". As files they could only be replaced by others.
constexpr std::array<std::string_view, 3> kStdout = {"/dev/stdout", "/dev/fd/1", "/proc/self/fd/1"};

CLI::Option* add_path(CLI::App& app, const std::string& name, const std::string& help, std::string& value) {
  return add_text(app, name, "FILE", help, [option = long_name(name), &value](const std::string& text) {
    if (text.empty()) throw usage_error(option, text, "the name of a file");
    value = std::ranges::find(kStdout, text) == kStdout.end() ? text : "-";
  });
}

void add_loudness(CLI::App& app, bool& quiet, bool& verbose) {
  CLI::Option* const silent = app.add_flag("-q,--quiet", quiet, "Say nothing unless something is wrong");
  silent->group(kGeneralGroup);
  app.add_flag("-v,--verbose", verbose, "Say where the time went, which rays were traced, what was left out")
      ->excludes(silent)
      ->group(kGeneralGroup);
}

void add_picture_format(CLI::App& app, std::optional<image::PictureFormat>& format) {
  add_text(app, "--format", shape_of(kFormats), "The picture's format (default: by its name; to stdout png)",
           [&format](const std::string& text) {
             format = static_cast<image::PictureFormat>(parse_choice("--format", text, kFormats));
           });
}

void add_cache_options(CLI::App& app, CacheChoice& cache) {
  const std::string group = "Cache";
  add_text(app, "--cache", "DIR", "Keep prepared scenes there (default: the user's cache directory)",
           [&cache](const std::string& text) {
             if (text.empty()) throw usage_error("--cache", text, "a folder (--no-cache: no cache)");
             cache.folder = text;
           })
      ->group(group);
  app.add_flag("--no-cache", cache.off, "Read and build the scene anew, and don't keep it")->group(group);
  add_text(app, "--cache-size", "BYTES", "The most that all kept scenes may take, as in 500M (default 4G)",
           [&cache](const std::string& text) { cache.max_bytes = parse_bytes("--cache-size", text); })
      ->group(group);
}

CLI::Option* add_build_option(CLI::App& app, BuildQuality& quality) {
  return add_choice(app, "--build", "Time spent on the tree (default: balanced)", prepare::kQualityNames,
                    quality);
}

void add_geometry_option(CLI::App& app, VertexPrecision& geometry) {
  static constexpr std::array<std::string_view, 3> kGeometries = {"float", "double", "auto"};
  add_choice(app, "--geometry",
             "What vertices are: float (default), double (exact, and slower), or auto: double where "
             "they are no floats",
             kGeometries, geometry);
}

void add_tree_options(CLI::App& app, TreeOptions& tree) {
  const std::string group = "Tree";
  add_build_option(app, tree.quality)->group(group);
  add_int(app, "--tree-depth", "Deepest leaf (default: 8 + 1.3*log2 of the primitives)", 0, 64,
          tree.max_depth)
      ->group(group);
  add_real(app, "--cost-traverse", "C", "Cost of one inner node in the surface area heuristic (default 1)", 0,
           1e6, tree.cost_traverse)
      ->group(group);
  add_real(app, "--cost-intersect", "C", "Cost of one leaf test (default 2)", 1e-6, 1e6, tree.cost_intersect)
      ->group(group);
  add_text(app, "--memory", "BYTES", "The most that the scene may take, as in 500M: the tree gets coarser",
           [&tree](const std::string& text) { tree.memory_bytes = parse_bytes("--memory", text); })
      ->group(group);
}

CLI::Option* add_device_option(CLI::App& app, const std::string& help, std::string& device) {
  return add_text(app, "--device", "auto|cpu|gpu|NAME", help, [&device](const std::string& text) {
    if (text.empty()) throw usage_error("--device", text, "auto, cpu, gpu, a number or a part of a name");
    device = text;
  });
}

CLI::Option* add_schedule_option(CLI::App& app, const std::string& help, DeviceOptions& device) {
  return add_choice(app, "--schedule", help, kSchedules, device.schedule);
}

void add_device_options(CLI::App& app, DeviceOptions& device, Traversal& traversal, Precision& precision) {
  const std::string group = "Device";
  device.tunings = tuning::default_file();
  app.add_flag_callback(
         "--no-tuning", [&device] { device.tunings.clear(); },
         "Leave aside what 'kdray tune' found; take what kdray ships with")
      ->group(group);
  add_device_option(app,
                    "The device: a number from 'kdray devices' or a part of its name; several with commas",
                    device.device)
      ->group(group);
  add_int(app, "--queues", "Command queues, each on its own equal part of the device (default 1)", 1, 1024,
          device.queues)
      ->group(group);
  add_int(app, "--work-group",
          "Work-items in a group of the per-ray kernels (default: chosen for the device)", 1, 65536,
          device.work_group)
      ->group(group);
  add_choice(app, "--traversal", "How rays walk the tree (default: auto)", kTraversals, traversal)
      ->group(group);
  add_schedule_option(
      app, "Launches: slices (all stages in one, for CPUs), global (one for each, a ray per work-item), auto",
      device)
      ->group(group);
  add_choice(app, "--precision", "Arithmetic of the kernels: float (default), double (slow, as a reference)",
             kPrecisions, precision)
      ->group(group);
}

}  // namespace kdray::cli
