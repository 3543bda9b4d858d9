// What    Options: how the text of one becomes a value (numbers, sizes, names from a list), the one way
//         options are added, and those that several commands share.
// Why     One place, so that every option is as strict (the whole text counts) and every message has the same
//         form; options are added as text, so that a wrong value gives kdray's own message and never CLI11's.
// Errors  kdray::Error, ErrorCode::usage: the option, what was given, what is accepted.
#pragma once

#include <CLI/CLI.hpp>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/image/picture_file.h"
#include "kdray/error.h"
#include "kdray/kdray.h"

namespace kdray::cli {

struct Size {
  int width = 0, height = 0;
};

[[nodiscard]] Error usage_error(std::string_view option, std::string_view given, std::string_view wanted);

int parse_int(std::string_view option, std::string_view text, int lo, int hi);
double parse_real(std::string_view option, std::string_view text, double lo, double hi);

// Reads "1,2.5,-3". Returns no numbers where a part is none.
std::vector<double> parse_numbers(std::string_view text);

// Reads "4096", "500M", "1.5g": bytes, or KiB, MiB, GiB or TiB where K, M, G or T follows, small or large.
std::uint64_t parse_bytes(std::string_view option, std::string_view text);

// Reads "640x480"; each side from 1 to `side_max`, and no more than `pixels_max` pixels.
Size parse_size(std::string_view option, std::string_view text, int side_max, long long pixels_max);

// Reads "200x100+30+40": width and height, and where that part begins, from the top left.
PixelRect parse_crop(std::string_view option, std::string_view text);

// What --samples says: "16", "adaptive", "adaptive:0.01".
struct Samples {
  int number = 0;     // 0: adaptive
  double target = 0;  // of adaptive sampling
};
Samples parse_samples(std::string_view option, std::string_view text);

// Reads "srgb", or the exponent G of v^(1/G).
image::Transfer parse_gamma(std::string_view option, std::string_view text);

// Returns the place of the text among `accepted`; it has to be one of them.
std::size_t parse_choice(std::string_view option, std::string_view text,
                         std::span<const std::string_view> accepted);

// Reads "a,b,c", each one of `accepted`; a name given twice counts once.
std::vector<std::string> parse_list(std::string_view option, std::string_view text,
                                    std::span<const std::string_view> accepted);

// Reads a colour: "skyblue", "#fff", "#87ceeb", or "R,G,B" in linear values. `others` are what the option
// takes besides, for its message.
Color parse_color(std::string_view option, std::string_view text, std::string_view others);

// Adds an option whose text goes to `take`; `shape` stands for the value in --help: "FILE" for any, "8|16"
// for these, "auto|N" for this word or any number.
CLI::Option* add_text(CLI::App& app, const std::string& name, const std::string& shape,
                      const std::string& help, std::function<void(const std::string&)> take);

// The names as an option's shape: "a|b|c".
std::string shape_of(std::span<const std::string_view> names);

// Adds an option that takes the name of an enumeration's value; the names come in the order of the values,
// and outlive the option.
template <class Choice>
CLI::Option* add_choice(CLI::App& app, const std::string& name, const std::string& help,
                        std::span<const std::string_view> names, Choice& choice) {
  return add_text(app, name, shape_of(names), help, [name, names, &choice](const std::string& text) {
    choice = static_cast<Choice>(parse_choice(name, text, names));
  });
}

// Adds an option that takes some of these names, with commas between; they outlive the option.
CLI::Option* add_list(CLI::App& app, const std::string& name, const std::string& help,
                      std::span<const std::string_view> names, std::vector<std::string>& chosen);

CLI::Option* add_int(CLI::App& app, const std::string& name, const std::string& help, int lo, int hi,
                     int& value);
CLI::Option* add_real(CLI::App& app, const std::string& name, const std::string& shape,
                      const std::string& help, double lo, double hi, double& value);
// What a width alone means: a square, or a height of 0, which follows from the scene's aspect ratio.
enum class OneSide { square, by_aspect };
// --size WxH|W
CLI::Option* add_size(CLI::App& app, const std::string& help, int side_max, long long pixels_max, int& width,
                      int& height, OneSide one_side = OneSide::square);
CLI::Option* add_path(CLI::App& app, const std::string& name, const std::string& help, std::string& value);
// --quiet --verbose
void add_loudness(CLI::App& app, bool& quiet, bool& verbose);
// --format png|exr
void add_picture_format(CLI::App& app, std::optional<image::PictureFormat>& format);

// Where prepared scenes are kept.
struct CacheChoice {
  std::string folder;  // empty: the user's own
  bool off = false;
  std::uint64_t max_bytes = CacheOptions().max_bytes;
};

// --cache --no-cache --cache-size
void add_cache_options(CLI::App& app, CacheChoice& cache);

CLI::Option* add_build_option(CLI::App& app, BuildQuality& quality);
void add_geometry_option(CLI::App& app, VertexPrecision& geometry);

// --build --tree-depth --cost-traverse --cost-intersect
void add_tree_options(CLI::App& app, TreeOptions& tree);

// --device
CLI::Option* add_device_option(CLI::App& app, const std::string& help, std::string& device);

// --schedule
CLI::Option* add_schedule_option(CLI::App& app, const std::string& help, DeviceOptions& device);

// --device --queues --work-group --traversal --schedule --precision --no-tuning
void add_device_options(CLI::App& app, DeviceOptions& device, Traversal& traversal, Precision& precision);

}  // namespace kdray::cli
