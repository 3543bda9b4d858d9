#include "apps/cli/options.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "accel/prepare/quality.h"
#include "apps/cli/parse.h"
#include "device/tuning/database.h"

namespace kdray::cli {

namespace {

// In the order of Traversal.
constexpr std::array<std::string_view, 5> kTraversals = {"auto", "binary", "wide", "packet", "batch"};
constexpr std::array<std::string_view, 3> kSchedules = {"auto", "slices",
                                                        "global"};  // in the order of Schedule

// "-o,--output" -> "--output", for messages.
std::string long_name(const std::string& name) {
  return name.substr(name.find("--"));
}

}  // namespace

CLI::Option* add_text(CLI::App& app, const std::string& name, const std::string& shape,
                      const std::string& help, std::function<void(const std::string&)> take) {
  return app.add_option_function<std::string>(name, std::move(take), help)->type_name(shape);
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
                      int& height) {
  return add_text(app, "--size", "WxH", help,
                  [side_max, pixels_max, &width, &height](const std::string& text) {
                    const Size size = parse_size("--size", text, side_max, pixels_max);
                    width = size.width, height = size.height;
                  });
}

CLI::Option* add_path(CLI::App& app, const std::string& name, const std::string& help, std::string& value) {
  return add_text(app, name, "FILE", help, [option = long_name(name), &value](const std::string& text) {
    if (text.empty()) throw usage_error(option, text, "the name of a file");
    value = text;
  });
}

void add_loudness(CLI::App& app, bool& quiet, bool& verbose) {
  CLI::Option* const silent = app.add_flag("-q,--quiet", quiet, "Say nothing unless something is wrong");
  app.add_flag("-v,--verbose", verbose, "Say where the time went, which rays were traced, what was left out")
      ->excludes(silent);
}

void add_picture_format(CLI::App& app, std::optional<image::PictureFormat>& format) {
  static constexpr std::array<std::string_view, 2> kFormats = {"png", "exr"};
  add_text(app, "--format", "NAME", "The picture's format: png, exr (default: by its name; to stdout png)",
           [&format](const std::string& text) {
             const bool exr = parse_choice("--format", text, kFormats) == "exr";
             format = exr ? image::PictureFormat::exr : image::PictureFormat::png;
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
  return add_text(app, "--build", "NAME", "Time spent on the tree: fast, balanced (default), best",
                  [&quality](const std::string& text) {
                    parse_choice("--build", text, prepare::kQualityNames);
                    const auto name =
                        std::find(prepare::kQualityNames.begin(), prepare::kQualityNames.end(), text);
                    quality = static_cast<BuildQuality>(name - prepare::kQualityNames.begin());
                  });
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

void add_device_options(CLI::App& app, DeviceOptions& device, Traversal& traversal, Precision& precision) {
  const std::string group = "Device";
  device.tunings = tuning::default_file();
  app.add_flag_callback(
         "--no-tuning", [&device] { device.tunings.clear(); },
         "Leave aside what 'kdray tune' found; take what kdray ships with")
      ->group(group);
  static constexpr std::array<std::string_view, 2> kPrecisions = {"float", "double"};
  add_text(app, "--device", "SPEC",
           "auto, cpu, gpu, a number from 'kdray devices', or a part of a name; several with commas",
           [&device](const std::string& text) {
             if (text.empty())
               throw usage_error("--device", text, "auto, cpu, gpu, a number or a part of a name");
             device.device = text;
           })
      ->group(group);
  add_int(app, "--queues", "Command queues, each on its own equal part of the device (default 1)", 1, 1024,
          device.queues)
      ->group(group);
  add_int(app, "--work-group",
          "Work-items in a group of the per-ray kernels (default: chosen for the device)", 1, 65536,
          device.work_group)
      ->group(group);
  add_text(app, "--traversal", "NAME", "How rays walk the tree: auto, binary, wide, packet, batch",
           [&traversal](const std::string& text) {
             parse_choice("--traversal", text, kTraversals);
             const auto name = std::find(kTraversals.begin(), kTraversals.end(), text);
             traversal = static_cast<Traversal>(name - kTraversals.begin());
           })
      ->group(group);
  add_text(app, "--schedule", "NAME",
           "Launches: slices (all stages in one, for CPUs), global (one for each, a ray per work-item), auto",
           [&device](const std::string& text) {
             parse_choice("--schedule", text, kSchedules);
             const auto name = std::find(kSchedules.begin(), kSchedules.end(), text);
             device.schedule = static_cast<Schedule>(name - kSchedules.begin());
           })
      ->group(group);
  add_text(app, "--precision", "NAME",
           "Arithmetic of the kernels: float (default), double (slow, as a reference)",
           [&precision](const std::string& text) {
             const bool in_double = parse_choice("--precision", text, kPrecisions) == "double";
             precision = in_double ? Precision::float64 : Precision::float32;
           })
      ->group(group);
}

}  // namespace kdray::cli
