#include "apps/cli/view_options.h"

#include <algorithm>
#include <cctype>

#include "apps/cli/options.h"
#include "apps/cli/parse.h"
#include "io/image/transfer.h"

namespace kdray::cli {

namespace {

View::Vector parse_vector(std::string_view option, std::string_view text) {
  const std::vector<double> numbers = parse_numbers(text);
  if (numbers.size() != 3) throw usage_error(option, text, "X,Y,Z");
  return {numbers[0], numbers[1], numbers[2]};
}

// "z", "-x", or a direction in numbers.
View::Vector parse_up(std::string_view option, std::string_view text) {
  static constexpr std::string_view kAxes = "xyz";
  View::Vector up = {};
  const bool down = text.starts_with('-');
  const std::string_view axis = text.substr(down ? 1 : 0);
  if (axis.size() == 1 && kAxes.find(axis) != std::string_view::npos) {
    up[kAxes.find(axis)] = down ? -1 : 1;
    return up;
  }
  const std::vector<double> numbers = parse_numbers(text);
  const auto is_zero = [](double x) { return x == 0; };
  if (numbers.size() != 3 || std::ranges::all_of(numbers, is_zero))
    throw usage_error(option, text, "x, y, z, -x, -y, -z, or X,Y,Z, not all 0");
  std::ranges::copy(numbers, up.begin());
  return up;
}

// Two hexadecimal digits of "#rrggbb", as sRGB has them.
float parse_hex(std::string_view text, std::size_t at) {
  const auto digit = [](char c) { return c <= '9' ? c - '0' : (c | 0x20) - 'a' + 10; };
  const int value = digit(text[at]) * 16 + digit(text[at + 1]);
  return static_cast<float>(image::decode(image::Transfer{}, value / 255.0));
}

std::array<float, 3> parse_color(std::string_view option, std::string_view text) {
  const auto is_hex = [](char c) { return std::isxdigit(static_cast<unsigned char>(c)) != 0; };
  if (text.size() == 7 && text[0] == '#' && std::ranges::all_of(text.substr(1), is_hex))
    return {parse_hex(text, 1), parse_hex(text, 3), parse_hex(text, 5)};
  constexpr double kMost = 1e6;
  const std::vector<double> numbers = parse_numbers(text);
  const auto is_good = [](double x) { return x >= 0 && x <= kMost; };
  if (numbers.size() != 3 || !std::ranges::all_of(numbers, is_good))
    throw usage_error(option, text, "transparent, #rrggbb, or R,G,B in linear values, each from 0");
  return {static_cast<float>(numbers[0]), static_cast<float>(numbers[1]), static_cast<float>(numbers[2])};
}

}  // namespace

void add_view_options(CLI::App& app, ViewOptions& options) {
  const std::string group = "View";
  const auto add = [&app, &options, &group](const std::string& name, const std::string& shape,
                                            const std::string& help, auto take) {
    return add_text(app, name, shape, help,
                    [name, take, &options](const std::string& text) {
                      options.any = true;
                      take(name, text);
                    })
        ->group(group);
  };
  View& view = options.view;
  add("--from", "X,Y,Z", "Where the camera is (default: the scene's, or where all is in the picture)",
      [&view](const std::string& name, const std::string& text) { view.from = parse_vector(name, text); });
  add("--at", "X,Y,Z", "What it looks at",
      [&view](const std::string& name, const std::string& text) { view.at = parse_vector(name, text); });
  add("--up", "X,Y,Z", "What is up: a direction, or x, y, z, -x, -y, -z (scans often have z)",
      [&view](const std::string& name, const std::string& text) { view.up = parse_up(name, text); });
  CLI::Option* const fov = add("--fov", "DEGREES", "Angle of view over the picture's full height",
                               [&view](const std::string& name, const std::string& text) {
                                 view.fov = parse_real(name, text, 1e-3, 179.9);
                               });
  add("--camera", "N", "Which of the cameras that the file has, from 0",
      [&view](const std::string& name, const std::string& text) {
        view.camera = parse_int(name, text, 0, 1 << 20);
      });
  add("--ortho", "[WIDTH]", "Parallel rays; the picture is WIDTH wide (default: as wide as the scene needs)",
      [&view](const std::string& name, const std::string& text) {
        view.ortho_width = text.empty() ? 0 : parse_real(name, text, 1e-30, 1e30);
      })
      ->expected(0, 1)
      ->excludes(fov);
  add("--aperture", "D", "A thin lens of this diameter: what is not in focus is blurred (0: a pinhole)",
      [&view](const std::string& name, const std::string& text) {
        view.aperture = parse_real(name, text, 0, 1e30);
      });
  add("--focus", "DISTANCE", "How far off, along the view, what is in focus is (default: as far as --at)",
      [&view](const std::string& name, const std::string& text) {
        view.focus = parse_real(name, text, 1e-30, 1e30);
      });
  add("--headlight", "S", "One more light at the camera, of strength S (as in 0.5)",
      [&view](const std::string& name, const std::string& text) {
        view.headlight = parse_real(name, text, 0, 1000);
      });
  add("--background", "COLOR", "R,G,B (linear), #rrggbb, or transparent: the picture gets alpha",
      [&options](const std::string& name, const std::string& text) {
        if (text == "transparent")
          options.transparent = true;
        else
          options.view.background = parse_color(name, text);
      });
}

std::vector<float> coverage(const PreparedScene& scene, const DeviceOptions& device,
                            const RenderOptions& render) {
  RenderOptions options = render;
  options.depth = 1;
  options.channels.clear();
  options.progress = {};
  options.timeline = false;
  options.ledger.reset();
  const Picture picture = Renderer(scene.coverage(), device).render(options);
  std::vector<float> shares(picture.rgb.size() / 3);
  for (std::size_t i = 0; i < shares.size(); ++i) shares[i] = std::clamp(picture.rgb[3 * i], 0.0f, 1.0f);
  return shares;
}

void take_out_background(std::span<const float> coverage, std::span<const float, 3> background,
                         std::vector<float>& rgb) {
  for (std::size_t i = 0; i < coverage.size(); ++i)
    for (std::size_t c = 0; c < 3; ++c) {
      float& value = rgb[3 * i + c];
      // Where nothing is covered nothing may be left, however the sum was rounded.
      value = coverage[i] == 0 ? 0 : std::max(0.0f, value - (1 - coverage[i]) * background[c]);
    }
}

}  // namespace kdray::cli
