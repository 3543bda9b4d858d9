// Pictures: of a scene, and to files.
#include <nanobind/stl/array.h>
#include <nanobind/stl/function.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "arrays.h"
#include "interrupt.h"
#include "io/image/picture_file.h"
#include "parts.h"
#include "scene/model/scene.h"

namespace kdray::python {

namespace {

namespace nb = nanobind;
using namespace nb::literals;

using Pixels = nb::ndarray<const float, nb::ndim<3>, nb::c_contig, nb::device::cpu>;
using Values = nb::ndarray<const float, nb::c_contig, nb::device::cpu>;
using Progress = std::function<void(double)>;
// These are: from, at, up, fov, ortho_width, hither, aperture, focus.
using CameraNumbers = std::array<double, 14>;

Camera camera_of(const CameraNumbers& n) {
  return {{n[0], n[1], n[2]}, {n[3], n[4], n[5]}, {n[6], n[7], n[8]}, n[9], n[10], n[11], n[12], n[13]};
}

// Calls Python's function, whose exceptions end the picture.
std::function<void(double)> told(const std::optional<Progress>& progress) {
  if (!progress) return {};
  return [&progress = *progress](double share) {
    const nb::gil_scoped_acquire gil;
    progress(share);
  };
}

template <class T>
T named(const std::string& name, std::initializer_list<std::pair<const char*, T>> values, const char* what) {
  std::string all;
  for (const auto& [n, value] : values) {
    if (name == n) return value;
    all += (all.empty() ? "\"" : ", \"") + std::string(n) + "\"";
  }
  throw Error(ErrorCode::usage, std::string(what) + " is one of " + all + ", not \"" + name + "\"");
}

// Whether there is neither a camera nor a light in the scene.
bool can_be_in_studio(const Scene& scene) {
  const PreparedScene prepared = scene.prepared();
  const scene::Framing& framing = prepared.settings().framing;
  return framing.camera && framing.lights;
}

RenderOptions options_of(int width, int height, int samples, int depth, double min_weight, double adaptive,
                         const std::string& mode, const std::string& precision) {
  RenderOptions o;
  o.width = width;
  o.height = height;
  o.samples = samples;
  o.depth = depth;
  o.min_weight = min_weight;
  o.adaptive_target = adaptive;
  o.mode =
      named<Mode>(mode, {{"auto", Mode::automatic}, {"pdprt", Mode::pdprt}, {"odprt", Mode::odprt}}, "mode");
  o.precision = named<Precision>(precision, {{"float", Precision::float32}, {"double", Precision::float64}},
                                 "precision");
  o.cancel = cancel_on_signals();
  return o;
}

nb::tuple arrays_of(Picture&& picture) {
  nb::dict channels;
  for (Channel& channel : picture.channels) channels[channel.name.c_str()] = owned(std::move(channel.values));
  return nb::make_tuple(picture.width, picture.height, owned(std::move(picture.rgb)), channels,
                        picture.warnings);
}

image::Image image_of(const Pixels& pixels) {
  if (pixels.shape(2) != 3) throw Error(ErrorCode::input, "a picture has three values to a pixel");
  image::Image image{static_cast<int>(pixels.shape(1)), static_cast<int>(pixels.shape(0)), {}};
  image.pixels.resize(pixels.shape(0) * pixels.shape(1));
  const float* const values = pixels.data();
  for (std::size_t i = 0; i < image.pixels.size(); ++i)
    image.pixels[i] = {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
  return image;
}

void place_within(const std::array<int, 4>& within, image::Image& image) {
  const auto& [x, y, width, height] = within;
  constexpr int kMost = 1 << 24;
  const bool fits = x >= 0 && y >= 0 && width >= 1 && height >= 1 && width <= kMost && height <= kMost &&
                    image.width <= width - x && image.height <= height - y;
  if (!fits) throw Error(ErrorCode::usage, "within: the picture does not lie in that one");
  image.x = x, image.y = y, image.whole_width = width, image.whole_height = height;
}

std::vector<image::Channel> channels_of(const std::vector<std::pair<std::string, Values>>& given) {
  std::vector<image::Channel> channels;
  for (const auto& [name, values] : given)
    channels.push_back({name, std::vector<float>(values.data(), values.data() + values.size())});
  return channels;
}

void check_channels(const Pixels& pixels, const std::vector<image::Channel>& channels) {
  for (const image::Channel& channel : channels)
    if (channel.values.size() != pixels.shape(0) * pixels.shape(1))
      throw Error(ErrorCode::input, "the channel " + channel.name + " is not of the picture's size");
}

}  // namespace

Look look_of(const std::string& name) {
  return named<Look>(name, {{"studio", Look::studio}, {"plain", Look::plain}}, "look");
}

void add_pictures(nb::module_& module, SceneClass scene) {
  scene.def(
      "render",
      [](const Scene& s, const std::optional<CameraNumbers>& camera, int width, int height, int samples,
         int depth, double min_weight, double adaptive, const std::string& mode, const std::string& precision,
         const std::vector<std::string>& channels, const std::optional<Progress>& progress,
         const std::string& look, const std::optional<std::array<int, 4>>& crop) {
        Picture picture;
        {
          RenderOptions o = options_of(width, height, samples, depth, min_weight, adaptive, mode, precision);
          if (camera) o.camera = camera_of(*camera);
          o.channels = channels;
          if (crop) o.crop = PixelRect{(*crop)[0], (*crop)[1], (*crop)[2], (*crop)[3]};
          const Look shown = look_of(look);
          if (samples == 0 && !(shown == Look::studio && can_be_in_studio(s))) o.samples = 1;
          const WithoutGil released;
          o.progress = told(progress);
          picture = s.render(o, shown);
        }
        return arrays_of(std::move(picture));
      },
      "camera"_a.none(), "width"_a, "height"_a, "samples"_a, "depth"_a, "min_weight"_a, "adaptive"_a,
      "mode"_a, "precision"_a, "channels"_a, "progress"_a.none(), "look"_a, "crop"_a.none());
  module.def(
      "write_picture",
      [](const std::string& file, const Pixels& pixels,
         const std::vector<std::pair<std::string, Values>>& channels, double gamma, double exposure, int bits,
         const std::optional<std::array<int, 4>>& within) {
        if (bits != 8 && bits != 16) throw Error(ErrorCode::usage, "a PNG has 8 or 16 bits");
        const std::vector<image::Channel> beside = channels_of(channels);
        check_channels(pixels, beside);
        if (!(std::abs(exposure) <= 100)) throw Error(ErrorCode::usage, "exposure is from -100 to 100");
        const image::WriteOptions options{{gamma == 0, gamma}, bits, exposure};
        image::Image image = image_of(pixels);
        if (within) place_within(*within, image);
        const image::Written written = image::write_picture(file, image, beside, options);
        std::vector<std::string> files;
        for (const auto& path : written.files) files.push_back(path.string());
        return files;
      },
      "file"_a, "pixels"_a, "channels"_a, "gamma"_a, "exposure"_a, "bits"_a, "within"_a.none());
  module.def("encode_png", [](const Pixels& pixels) {
    const std::string bytes = image::encode_picture(image::PictureFormat::png, image_of(pixels), {}, {});
    return nb::bytes(bytes.data(), bytes.size());
  });
}

}  // namespace kdray::python
