// What    Pictures of the standard scenes against POV-Ray 3.7's of the same files (1024x1024, depth 5,
//         linear, no antialiasing): another program, another author, the same model.
#include <gtest/gtest.h>

#include <algorithm>

#include "io/image/compare.h"
#include "io/image/picture_file.h"
#include "pictures/render.h"
#include "support/data.h"

namespace kdray::test {
namespace {

class Povray : public testing::TestWithParam<const char*> {};

TEST_P(Povray, SeesTheSame) {
  const std::string name = GetParam();
  const std::filesystem::path file = data_path("spd/" + name + ".nff.gz");
  const std::filesystem::path reference = data_path("spd/povray/" + name + ".png");
  KDRAY_NEED_DATA(file);
  KDRAY_NEED_DATA(reference);
  const image::Image wanted = image::read_picture(reference, {.srgb = false, .gamma = 1});
  const Scene scene = Scene::load(file);
  Renderer renderer(scene, {}, device_of());
  const Picture picture = renderer.render(exact_options(1024, 1024));
  image::Image found{picture.width, picture.height, {}};
  found.pixels.reserve(picture.rgb.size() / 3);
  // Values are rounded as a PNG holds them: else POV-Ray's own rounding to 8 bits, 1e-3 in the mean, would be
  // all that is measured.
  for (std::size_t i = 0; i < picture.rgb.size(); i += 3) {
    const vec3 pixel(picture.rgb[i], picture.rgb[i + 1], picture.rgb[i + 2]);
    found.pixels.push_back(glm::round(glm::clamp(pixel, vec3(0), vec3(1)) * 255.0f) / 255.0f);
  }
  const image::Difference d = image::compare(found, wanted);
  RecordProperty("mean_absolute", std::to_string(d.mean_absolute));
  EXPECT_LT(d.mean_absolute, 1e-3) << "rmse " << d.rmse << ", share of differing pixels "
                                   << d.differing_share;
}

INSTANTIATE_TEST_SUITE_P(Spd, Povray, testing::Values("balls", "tetra", "teapot", "tree"),
                         [](const auto& info) { return std::string(info.param); });

}  // namespace
}  // namespace kdray::test
