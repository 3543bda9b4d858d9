// What    Options that several commands share, and the one way options are added: as text, parsed by
//         parse.h, so that a wrong value gives kdray's own message and never CLI11's.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <optional>
#include <string>

#include "io/image/format.h"
#include "kdray/kdray.h"

namespace kdray::cli {

// Adds an option whose text goes to `take`; `shape` stands for the value in --help.
CLI::Option* add_text(CLI::App& app, const std::string& name, const std::string& shape,
                      const std::string& help, std::function<void(const std::string&)> take);

CLI::Option* add_int(CLI::App& app, const std::string& name, const std::string& help, int lo, int hi,
                     int& value);
CLI::Option* add_real(CLI::App& app, const std::string& name, const std::string& shape,
                      const std::string& help, double lo, double hi, double& value);
// --size WxH
CLI::Option* add_size(CLI::App& app, const std::string& help, int side_max, long long pixels_max, int& width,
                      int& height);
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

// --build --tree-depth --cost-traverse --cost-intersect
void add_tree_options(CLI::App& app, TreeOptions& tree);

// --device --queues --work-group --traversal --schedule --precision --no-tuning
void add_device_options(CLI::App& app, DeviceOptions& device, Traversal& traversal, Precision& precision);

}  // namespace kdray::cli
