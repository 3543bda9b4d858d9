// What    Turns the text of an option into a value: numbers, sizes, names from a list. One place, so
//         that every option is as strict (the whole text counts) and every message has the same form.
// Errors  kdray::Error, ErrorCode::usage: the option, what was given, what is accepted.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/image/write.h"
#include "kdray/error.h"

namespace kdray::cli {

struct Size {
  int width = 0, height = 0;
};

[[nodiscard]] Error usage_error(std::string_view option, std::string_view given, std::string_view wanted);

int parse_int(std::string_view option, std::string_view text, int lo, int hi);
double parse_real(std::string_view option, std::string_view text, double lo, double hi);

// "1,2.5,-3"; none where a part is no number.
std::vector<double> parse_numbers(std::string_view text);

// "4096", "500M", "1.5g": in bytes, KiB, MiB, GiB or TiB with K, M, G or T behind it, small or large.
std::uint64_t parse_bytes(std::string_view option, std::string_view text);

// "640x480"; each side from 1 to `side_max`, and no more than `pixels_max` pixels.
Size parse_size(std::string_view option, std::string_view text, int side_max, long long pixels_max);

// "16", "adaptive", "adaptive:0.01".
struct Samples {
  int number = 0;     // 0: adaptive
  double target = 0;  // of adaptive sampling
};
Samples parse_samples(std::string_view option, std::string_view text);

// "srgb", or the exponent G of v^(1/G).
image::Transfer parse_gamma(std::string_view option, std::string_view text);

// One of `accepted`.
std::string parse_choice(std::string_view option, std::string_view text,
                         std::span<const std::string_view> accepted);

// "a,b,c", each one of `accepted`; a name given twice counts once.
std::vector<std::string> parse_list(std::string_view option, std::string_view text,
                                    std::span<const std::string_view> accepted);

}  // namespace kdray::cli
