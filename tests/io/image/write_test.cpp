
#include <gtest/gtest.h>

#include <cmath>

#include "io/image/picture_file.h"
#include "pictures.h"
#include "support/errors.h"
#include "support/folder.h"

namespace kdray::image {
namespace {

double largest_difference(const Image& a, const Image& b) {
  double largest = a.pixels.size() == b.pixels.size() && a.width == b.width ? 0 : INFINITY;
  for (std::size_t i = 0; i < a.pixels.size() && largest < 1; ++i)
    for (int c = 0; c < 3; ++c)
      largest = std::max(largest, std::abs(static_cast<double>(a.pixels[i][c]) - b.pixels[i][c]));
  return largest;
}

TEST(WritePicture, PngComesBackWithinHalfAStep) {
  const test::Folder folder;
  const Image image = noise(31, 17, 1);
  for (const Transfer& transfer : {Transfer{false, 1}, Transfer{true, 0}, Transfer{false, 2.2}})
    for (const int bits : {8, 16}) {
      write_picture(folder / "a.png", image, {}, {transfer, bits});
      const Image back = read_picture(folder / "a.png", transfer);
      // The curve's slope, at most 2.4 for these, turns half a step of the code into as much more.
      const double half_step = 0.5 / (bits == 16 ? 65535 : 255);
      EXPECT_LT(largest_difference(image, back),
                half_step * (transfer.srgb || transfer.gamma > 1 ? 2.4 : 1) + 1e-7);
    }
}

TEST(WritePicture, RowZeroIsTheTopInEveryFormat) {
  const test::Folder folder;
  Image image = flat(3, 2, vec3(0));
  image.pixels[0] = vec3(1, 0, 0);
  for (const char* name : {"a.png", "a.exr", "A.PNG"}) {
    write_picture(folder / name, image, {}, {});
    EXPECT_EQ(largest_difference(read_picture(folder / name, {}), image), 0) << name;
  }
}

TEST(WritePicture, CountsNans) {
  const test::Folder folder;
  Image image = flat(3, 2, vec3(0.5f));
  image.pixels[1] = vec3(NAN, 0, NAN);
  EXPECT_EQ(write_picture(folder / "a.png", image, {}, {}).nan_values, 2u);
  EXPECT_EQ(read_picture(folder / "a.png", {}).pixels[1], vec3(0));
  EXPECT_EQ(write_picture(folder / "b.png", flat(3, 2, vec3(INFINITY)), {}, {}).nan_values, 0u);
}

TEST(WritePicture, ChannelsGoBesideAPngAndIntoAnExr) {
  const test::Folder folder;
  const std::vector<float> values(6, 1);
  const std::vector<Channel> channels = {{"depth", values},    {"normal.x", values},  {"normal.y", values},
                                         {"normal.z", values}, {"primitive", values}, {"cost", values}};
  const Written png = write_picture(folder / "a.b.png", flat(3, 2, vec3(0)), channels, {});
  const std::vector<std::filesystem::path> names = {folder / "a.b.png", folder / "a.b.depth.png",
                                                    folder / "a.b.normal.png", folder / "a.b.primitive.png",
                                                    folder / "a.b.cost.png"};
  EXPECT_EQ(png.files, names);
  for (const auto& name : names) EXPECT_EQ(read_picture(name, {}).width, 3) << name;
  EXPECT_EQ(folder.n_entries(), 5u);
  EXPECT_EQ(write_picture(folder / "c.exr", flat(3, 2, vec3(0)), channels, {}).files.size(), 1u);
  EXPECT_EQ(folder.n_entries(), 6u);
}

// Colours are multiplied with alpha in memory and in an EXR, not in a PNG.
TEST(WritePicture, AlphaComesBack) {
  const test::Folder folder;
  Image image = flat(2, 2, vec3(0.5f));
  image.alpha = {1, 0.5f, 0, 0.2f};
  image.pixels[2] = vec3(0);
  image.pixels[3] = vec3(0.1f);
  write_picture(folder / "a.exr", image, {}, {});
  const Image exr = read_picture(folder / "a.exr", {});
  EXPECT_EQ(exr.alpha, image.alpha);
  EXPECT_EQ(exr.pixels[3], image.pixels[3]);
  for (const int bits : {8, 16}) {
    write_picture(folder / "a.png", image, {}, {.transfer = {}, .png_bits = bits});
    const Image png = read_picture(folder / "a.png", {});
    ASSERT_EQ(png.alpha.size(), 4u);
    const float step = bits == 8 ? 0.01f : 1e-4f;
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_NEAR(png.alpha[i], image.alpha[i], step) << i;
      EXPECT_NEAR(png.pixels[i].x, image.pixels[i].x, step) << i;
    }
  }
}

TEST(WritePicture, SaysWhatIsWrongWithTheName) {
  const test::Folder folder;
  const Image image = flat(2, 2, vec3(0));
  const auto write = [&](const std::string& name) {
    return [=, &folder] { write_picture(folder / name, image, {}, {}); };
  };
  EXPECT_TRUE(test::fails(write("a.jpg"), "end the name in .png or .exr"));
  EXPECT_TRUE(test::fails(write("a"), "no ending"));
  EXPECT_TRUE(test::fails(write("none/a.png"), "does not exist"));
  EXPECT_TRUE(test::fails([&] { picture_files(folder / "a.tif", {}, {}); }, ".tif"));
  EXPECT_TRUE(test::fails([&] { write_file(folder / "none/a.exr", ""); }, "does not exist"));
  EXPECT_EQ(folder.n_entries(), 0u);
}

TEST(WritePicture, RefusesWhatDoesNotFit) {
  const test::Folder folder;
  const Channel short_channel{"depth", {1, 2, 3}};
  EXPECT_TRUE(test::fails(
      [&] {
        write_picture(folder / "a.exr", flat(2, 2, vec3(0)), {&short_channel, 1}, {});
      },
      "does not fit", ErrorCode::internal));
  EXPECT_TRUE(test::fails(
      [&] {
        write_picture(folder / "a.png", flat(2, 2, vec3(0)), {}, {{false, -1}, 8});
      },
      "gamma", ErrorCode::usage));
  EXPECT_EQ(folder.n_entries(), 0u);
}

}  // namespace
}  // namespace kdray::image
