// What    The view on the command line against the same view in the file, and against closed forms: what a
//         sphere covers in parallel rays, what a mesh looks like that was turned instead of the camera.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "apps/cli/program.h"
#include "apps/cli/scenes.h"
#include "io/image/compare.h"
#include "io/image/picture_file.h"
#include "kdray/kdray.h"
#include "scene/gltf_samples.h"
#include "support/folder.h"

namespace kdray::test {
namespace {

namespace fs = std::filesystem;

constexpr double kPi = 3.141592653589793;

struct ViewTest : testing::Test {
  void SetUp() override { KDRAY_NEED_DEVICE(); }
  Folder folder;
  image::Image rendered(const std::string& scene, const std::vector<std::string>& options = {},
                        const std::string& size = "64x64") const {
    std::vector<std::string> arguments = {"render", folder / scene, "-o", folder / "out.exr",
                                          "-q",     "--size",       size};
    arguments.insert(arguments.end(), options.begin(), options.end());
    EXPECT_TRUE(succeeds(kdray(arguments)));
    return image::read_picture(folder / "out.exr", {});
  }
};

bool same_bits(const image::Image& a, const image::Image& b) {
  return a.pixels == b.pixels && a.alpha == b.alpha;
}

double mean_alpha(const image::Image& image) {
  double sum = 0;
  for (const float a : image.alpha) sum += a;
  return sum / static_cast<double>(image.alpha.size());
}

// A wedge of no symmetry; its corners as `turn` puts them.
std::string wedge(dvec3 (*turn)(const dvec3&)) {
  std::string text;
  for (const dvec3& v : {dvec3(0, 0, 0), dvec3(3, 0, 0), dvec3(0, 1, 0), dvec3(0, 0, 2)}) {
    const dvec3 t = turn(v);
    text += "v " + std::to_string(t.x) + " " + std::to_string(t.y) + " " + std::to_string(t.z) + "\n";
  }
  return text + "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
}

TEST_F(ViewTest, OptionsAreTheFilesCamera) {
  folder.put("a.nff", kSphereOnSquare);
  std::string other = kSphereOnSquare;
  const std::string own = "from 0 -6 3\nat 0 0 1\nup 0 0 1\nangle 40\n";
  other.replace(other.find(own), own.size(), "from -3 4 2.5\nat 0.5 0 0\nup 1 0 1\nangle 55\n");
  folder.put("b.nff", other);
  const image::Image wanted = rendered("b.nff");
  EXPECT_TRUE(same_bits(
      rendered("a.nff", {"--from", "-3,4,2.5", "--at=0.5,0,0", "--up", "1,0,1", "--fov", "55"}), wanted));
  EXPECT_FALSE(same_bits(rendered("a.nff"), wanted));
}

TEST_F(ViewTest, UpAloneIsAsIfTheMeshWereTurned) {
  folder.put("y.obj", wedge([](const dvec3& v) { return v; }));
  folder.put("z.obj", wedge([](const dvec3& v) { return dvec3(v.x, -v.z, v.y); }));
  folder.put("down.obj", wedge([](const dvec3& v) { return dvec3(v.x, -v.y, -v.z); }));
  const auto plain = [this](const std::string& scene, std::vector<std::string> options) {
    options.push_back("--look=plain");
    return rendered(scene, options);
  };
  const image::Image upright = plain("y.obj", {});
  EXPECT_TRUE(same_bits(plain("y.obj", {"--up", "y"}), upright));
  EXPECT_LT(image::compare(plain("z.obj", {"--up", "z"}), upright).rmse, 1e-3);
  EXPECT_LT(image::compare(plain("down.obj", {"--up", "-y"}), upright).rmse, 1e-3);
  EXPECT_GT(image::compare(plain("z.obj", {}), upright).rmse, 0.02) << "nothing was turned";
}

TEST_F(ViewTest, LightsThatTheFileLacksFollowTheCamera) {
  folder.put("y.obj", wedge([](const dvec3& v) { return v; }));
  for (const char* const from : {"9,1,0", "-9,1,0", "0,1,9", "0,1,-9", "1,-9,1"}) {
    for (const char* const look : {"plain", "studio"}) {
      const image::Image image =
          rendered("y.obj", {"--from", from, "--background", "transparent", "--look", look});
      ASSERT_GT(mean_alpha(image), 0.01) << from;
      double brightest = 0;
      for (const vec3& p : image.pixels) brightest = std::max<double>(brightest, p.x);
      EXPECT_GT(brightest, 0.25) << look << ", " << from << ": by ambient light alone it were under 0.1";
    }
  }
}

TEST_F(ViewTest, ASphereInParallelRaysCoversItsCircle) {
  folder.put("s.nff",
             "v\nfrom 0 0 5\nat 0 0 0\nup 0 1 0\nangle 40\nresolution 64 64\nf 1 1 1 1 0 1 0 0\ns 0 0 0 1\n");
  const double circle = kPi / 16;
  for (const char* const from : {"0,0,5", "0,0,1.5", "0,0,100"}) {
    const image::Image image =
        rendered("s.nff", {"--ortho", "4", "--from", from, "--samples", "64", "--background", "transparent"});
    EXPECT_NEAR(mean_alpha(image), circle, 0.002) << from;
    for (const float a : image.alpha) EXPECT_EQ(a * 64, std::round(a * 64)) << "no whole number of samples";
  }
  // As wide as the scene needs: 2, and a margin of a twentieth.
  const image::Image fitted =
      rendered("s.nff", {"--samples", "64", "--background", "transparent", "--ortho"});
  EXPECT_NEAR(mean_alpha(fitted), kPi / 4 / (1.05 * 1.05), 0.002);
  // Higher than wide: it is the width then that has to show all.
  const image::Image high = rendered("s.nff", {"--background", "transparent", "--ortho"}, "32x128");
  EXPECT_NEAR(mean_alpha(high), kPi / 16 / (1.05 * 1.05), 0.01);
}

TEST_F(ViewTest, ParallelRaysAreTheSameInEveryMode) {
  folder.put("a.nff", kSphereOnSquare);
  const image::Image plain = rendered("a.nff", {"--ortho"});
  EXPECT_FALSE(same_bits(plain, rendered("a.nff")));
  for (const std::vector<std::string>& mode : {std::vector<std::string>{"--mode=odprt", "--queues=2"},
                                               {"--traversal=binary"},
                                               {"--tile=5x5"},
                                               {"--schedule=global"}}) {
    std::vector<std::string> options = mode;
    options.push_back("--ortho");
    EXPECT_TRUE(same_bits(rendered("a.nff", options), plain)) << mode[0];
  }
  folder.put("a.json", R"({"camera": {"from": [0, 0, 9], "at": [0, 0, 0], "ortho": 3},
                           "objects": [{"type": "sphere", "center": [0, 0, 0], "radius": 1}]})");
  EXPECT_NEAR(mean_alpha(rendered("a.json", {"--background=transparent"})), kPi / 9, 0.01);
}

TEST_F(ViewTest, CamerasAreChosenByNumber) {
  GltfSample sample;
  const int positions = sample.vectors({0, 0, 0, 1, 0, 0, 0, 1, 0});
  sample.json["meshes"] = {{{"primitives", {{{"attributes", {{"POSITION", positions}}}}}}}};
  sample.json["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 0.5}}}},
                            {{"type", "orthographic"}, {"orthographic", {{"xmag", 1}, {"ymag", 1}}}}};
  const auto with_nodes = [&](int first, int second) {
    sample.json["nodes"] = {{{"mesh", 0}, {"children", {1, 2}}},
                            {{"camera", first}, {"translation", {0.5, 0.5, 3}}},
                            {{"camera", second}, {"translation", {0.5, 0.5, 3}}}};
    return sample.json.dump();
  };
  folder.put("a.gltf", with_nodes(0, 1));
  folder.put("b.gltf", with_nodes(1, 0));
  const image::Image first = rendered("a.gltf"), second = rendered("b.gltf");
  EXPECT_FALSE(same_bits(first, second));
  EXPECT_TRUE(same_bits(rendered("a.gltf", {"--camera", "0"}), first));
  EXPECT_TRUE(same_bits(rendered("a.gltf", {"--camera", "1"}), second));
  EXPECT_TRUE(fails_with(kdray({"render", folder / "a.gltf", "-o", folder / "a.png", "--camera", "2"}), 2,
                         "has cameras 0 to 1"));
}

// What is over the background is what the opaque picture shows.
TEST_F(ViewTest, ATransparentPictureOverItsBackgroundIsTheOpaqueOne) {
  folder.put("a.nff", kSphereOnSquare);  // its background is 0.1, 0.2, 0.4
  const image::Image opaque = rendered("a.nff", {"--samples", "4"});
  const image::Image clear = rendered("a.nff", {"--samples", "4", "--background", "transparent"});
  ASSERT_EQ(clear.alpha.size(), opaque.pixels.size());
  std::size_t n_clear = 0, n_partly = 0;
  for (std::size_t i = 0; i < clear.pixels.size(); ++i) {
    const vec3 over = clear.pixels[i] + (1 - clear.alpha[i]) * vec3(0.1f, 0.2f, 0.4f);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(over[c], opaque.pixels[i][c], 1e-6) << i;
    n_clear += clear.alpha[i] == 0, n_partly += clear.alpha[i] > 0 && clear.alpha[i] < 1;
    if (clear.alpha[i] == 0) {
      EXPECT_EQ(clear.pixels[i], vec3(0)) << i;
    }
  }
  EXPECT_GT(n_clear, 100u);
  EXPECT_GT(n_partly, 10u);
  ASSERT_TRUE(
      succeeds(kdray({"render", folder / "a.nff", "-o", folder / "a.png", "--background", "transparent"})));
  EXPECT_EQ(image::read_picture(folder / "a.png", {}).alpha.size(), 48u * 32u);
}

// The sky is seen in the mirror and taken out of the pixels behind it; one of one colour is that background.
TEST_F(ViewTest, ATransparentPictureBeforeASkyKeepsWhatMirrorsShowOfIt) {
  const auto text = [](const std::string& background) {
    return R"({"camera": {"from": [0, -6, 3], "at": [0, 0, 0], "fov": 40}, "background": )" + background +
           R"(, "lights": [{"type": "point", "position": [3, -4, 6]}],
              "materials": {"m": {"color": 0.2, "reflect": 0.7}},
              "objects": [{"type": "sphere", "center": [0, 0, 0], "radius": 1, "material": "m"}]})";
  };
  folder.put("colour.json", text("[0.1, 0.2, 0.4]"));
  folder.put("even.json",
             text(R"({"type": "gradient", "stops": [{"height": 0, "color": [0.1, 0.2, 0.4]}]})"));
  folder.put("sky.json", text(R"({"type": "gradient", "stops": [{"height": -1, "color": [1, 0.8, 0.3]},
                                                                   {"height": 1, "color": [0, 0.1, 1]}]})"));
  const std::vector<std::string> transparent = {"--samples=4", "--background=transparent"};
  const image::Image colour = rendered("colour.json", transparent), even = rendered("even.json", transparent);
  ASSERT_EQ(even.alpha, colour.alpha);
  for (std::size_t i = 0; i < even.pixels.size(); ++i)
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(even.pixels[i][c], colour.pixels[i][c], 1e-6) << i;

  const image::Image opaque = rendered("sky.json", {"--samples=4"}),
                     clear = rendered("sky.json", transparent);
  ASSERT_EQ(clear.alpha, colour.alpha);
  std::size_t n_clear = 0, n_whole = 0;
  for (std::size_t i = 0; i < clear.pixels.size(); ++i) {
    n_clear += clear.alpha[i] == 0, n_whole += clear.alpha[i] == 1;
    if (clear.alpha[i] == 0) {
      EXPECT_EQ(clear.pixels[i], vec3(0)) << i;
    }
    if (clear.alpha[i] == 1) {
      EXPECT_EQ(clear.pixels[i], opaque.pixels[i]) << i;
    }
    for (int c = 0; c < 3; ++c) EXPECT_LE(clear.pixels[i][c], opaque.pixels[i][c]) << i;
  }
  EXPECT_GT(n_clear, 1000u);
  EXPECT_GT(n_whole, 300u);

  folder.put("studio.json", R"({"background": {"type": "gradient", "stops": [
      {"height": -1, "color": [1, 0.8, 0.3]}, {"height": 1, "color": [0, 0.1, 1]}]}, "objects": [
      {"type": "sphere", "center": [0, 0, 0], "radius": 1, "material": {"color": 0.2, "reflect": 0.7}}]})");
  const image::Image in_studio = rendered("studio.json", {"--samples=4"}),
                     cut = rendered("studio.json", transparent);
  for (std::size_t i = 0; i < cut.pixels.size(); ++i)
    if (cut.alpha[i] == 1) {
      ASSERT_EQ(cut.pixels[i], in_studio.pixels[i]) << i;
    }
}

TEST_F(ViewTest, TheBackgroundIsTheColourAskedFor) {
  folder.put("a.nff", kSphereOnSquare);
  EXPECT_EQ(rendered("a.nff", {"--background", "0.25,0.5,2"}).pixels[0], vec3(0.25f, 0.5f, 2));
  ASSERT_TRUE(
      succeeds(kdray({"render", folder / "a.nff", "-o", folder / "a.png", "--background", "#2080fF"})));
  ASSERT_TRUE(
      succeeds(kdray({"render", folder / "a.nff", "-o", folder / "b.png", "--background", "0.014,0.216,1"})));
  const image::Image a = image::read_picture(folder / "a.png", {}),
                     b = image::read_picture(folder / "b.png", {});
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(a.pixels[0][c], b.pixels[0][c], 0.005f);
}

// A wedge on its longest side, before the studio's backdrop; the other look is what the library renders.
TEST_F(ViewTest, ALookIsAStudioUnlessItIsToBePlain) {
  const std::string file = folder.put("y.obj", wedge([](const dvec3& v) { return v; }));
  const image::Image studio = rendered("y.obj"), plain = rendered("y.obj", {"--look", "plain"});
  EXPECT_TRUE(same_bits(rendered("y.obj", {"--look=studio"}), studio));
  const Picture library = Renderer(Scene::load(file)).render({.width = 64, .height = 64});
  ASSERT_EQ(library.rgb.size(), 3 * plain.pixels.size());
  for (std::size_t i = 0; i < plain.pixels.size(); ++i)
    ASSERT_EQ(plain.pixels[i], vec3(library.rgb[3 * i], library.rgb[3 * i + 1], library.rgb[3 * i + 2])) << i;
  const auto darkest = [](const image::Image& image) {
    return std::ranges::min_element(image.pixels, {}, &vec3::x)->x;
  };
  EXPECT_EQ(darkest(plain), 0);
  EXPECT_GT(darkest(studio), 0.02f);
  for (const std::vector<std::string>& mode : {std::vector<std::string>{"--mode=odprt", "--queues=2"},
                                               {"--mode=pdprt", "--queues=2"},
                                               {"--schedule=global"},
                                               {"--traversal=batch"}})
    EXPECT_TRUE(same_bits(rendered("y.obj", mode), studio)) << mode[0];
}

TEST_F(ViewTest, AStudioWhoseBackgroundIsTransparentIsOneWithoutFloor) {
  folder.put("y.obj", wedge([](const dvec3& v) { return v; }));
  const image::Image image = rendered("y.obj", {"--background", "transparent"});
  ASSERT_EQ(image.alpha.size(), image.pixels.size());
  EXPECT_EQ(image.alpha, rendered("y.obj", {"--background", "transparent", "--samples=8"}).alpha);
  for (std::size_t i = 0; i < image.alpha.size(); ++i)
    if (image.alpha[i] == 0) {
      EXPECT_EQ(image.pixels[i], vec3(0)) << i;
    }
  EXPECT_GT(mean_alpha(image), 0.1);
}

TEST_F(ViewTest, AFileWithACameraOrLightsLooksAsItSays) {
  const std::string objects = R"("objects": [{"type": "sphere", "center": [0, 0, 0], "radius": 1}]})";
  folder.put("seen.json", R"({"camera": {"from": [0, 1, 5], "at": [0, 0, 0]}, )" + objects);
  folder.put("lit.json", R"({"lights": [{"type": "point", "position": [0, 9, 5]}], )" + objects);
  folder.put("both.nff", kSphereOnSquare);
  for (const char* const scene : {"seen.json", "lit.json", "both.nff"})
    EXPECT_TRUE(same_bits(rendered(scene, {}), rendered(scene, {"--look=plain"}))) << scene;
  const auto said = [&](const std::string& scene, const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments{"render", folder / scene, "-o", folder / "o.png", "--size=8x8"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome run = kdray(arguments);
    EXPECT_TRUE(succeeds(run));
    return run.err;
  };
  for (const char* const scene : {"seen.json", "lit.json"})
    EXPECT_EQ(said(scene).find("using the file's camera"), std::string::npos);
}

// A plinth with a small ball over it, along z.
TEST_F(ViewTest, WhatStandsOnZIsUprightAndALineSaysSo) {
  const auto tower = [](dvec3 (*turn)(const dvec3&)) {
    std::string text;
    for (int i = 0; i < 8; ++i) {
      const dvec3 v = turn({i & 1 ? 1.0 : -1.0, i & 2 ? 3.0 : 0.0, i & 4 ? 0.8 : -0.8});
      text += fmt::format("v {} {} {}\n", v.x, v.y, v.z);
    }
    const dvec3 top = turn({0.2, 6, 0.1});
    text += fmt::format("v {} {} {}\n", top.x, top.y, top.z);
    return text +
           "f 1 2 6 5\nf 1 3 4 2\nf 5 6 8 7\nf 1 5 7 3\nf 2 4 8 6\nf 3 9 4\nf 4 9 8\nf 8 9 7\nf 7 9 3\n";
  };
  const std::string y = folder.put("y.obj", tower([](const dvec3& v) { return v; }));
  const std::string z = folder.put("z.obj", tower([](const dvec3& v) { return dvec3(v.x, -v.z, v.y); }));
  EXPECT_LT(image::compare(rendered("z.obj"), rendered("y.obj")).rmse, 0.02);
  EXPECT_GT(image::compare(rendered("z.obj", {"--up=y"}), rendered("y.obj")).rmse, 0.05);
  const std::string told = "it stands on z";
  EXPECT_NE(kdray({"render", z, "-o", folder / "z.png", "--size=8x8"}).err.find(told), std::string::npos);
  EXPECT_EQ(kdray({"render", y, "-o", folder / "y.png", "--size=8x8"}).err.find(told), std::string::npos);
}

TEST(ViewOptions, WhatMakesNoViewIsRefused) {
  const Folder folder;
  const std::string scene = folder.put("a.nff", kSphereOnSquare), out = folder / "a.png";
  const auto refuses = [&](const std::vector<std::string>& options, const std::string& text) {
    std::vector<std::string> arguments = {"render", scene, "-o", out};
    arguments.insert(arguments.end(), options.begin(), options.end());
    return fails_with(kdray(arguments), 2, text);
  };
  EXPECT_TRUE(refuses({"--from", "1,2"}, "--from '1,2': expected X,Y,Z"));
  EXPECT_TRUE(refuses({"--at", "1,2,x"}, "X,Y,Z"));
  EXPECT_TRUE(refuses({"--up", "0,0,0"}, "not all 0"));
  EXPECT_TRUE(refuses({"--up", "w"}, "x, y, z"));
  EXPECT_TRUE(refuses({"--fov", "180"}, "--fov"));
  EXPECT_TRUE(refuses({"--look", "nice"}, "--look 'nice': expected one of plain, studio"));
  EXPECT_TRUE(refuses({"--ortho", "0"}, "--ortho"));
  EXPECT_TRUE(refuses({"--ortho", "2", "--fov", "40"}, "--ortho"));
  EXPECT_TRUE(refuses({"--background", "#12345"}, "transparent"));
  EXPECT_TRUE(refuses({"--background", "1,1,-1"}, "each from 0"));
  EXPECT_TRUE(refuses({"--background", "transparent", "--samples", "adaptive"}, "--samples"));
  if (!has_device()) return;
  EXPECT_TRUE(refuses({"--from", "0,0,5", "--at", "0,0,0"}, "parallel to the view direction"));
  EXPECT_TRUE(refuses({"--from", "0,0,1", "--at", "0,0,1"}, "the same point"));
  EXPECT_TRUE(refuses({"--camera", "3"}, "has one camera, number 0"));
}

// Of three balls along the axes, red, green and blue, those that lie towards the right and upwards.
TEST_F(ViewTest, SidesShowAllOfTheSceneFromThere) {
  const auto ball = [](const std::string& at, const std::string& color) {
    return R"({"type": "sphere", "center": )" + at + R"(, "radius": 0.3, "material": {"emission": )" + color +
           "}}";
  };
  const std::string objects = R"("objects": [)" + ball("[2,0,0]", "[1,0,0]") + ", " +
                              ball("[0,2,0]", "[0,1,0]") + ", " + ball("[0,0,2]", "[0,0,1]") + ", " +
                              ball("[0,0,0]", "[0.5,0.5,0.5]") + "]}";
  folder.put("bare.json", "{" + objects);
  folder.put(
      "seen.json",
      R"({"camera": {"from": [0, 0, 9], "at": [0, 0, 99], "up": [0, 0.8, 0.6]}, "lights": [], )" + objects);
  // Where a colour's middle is seen: to the right and up, from -1 to 1.
  const auto middle = [](const image::Image& image, int c) {
    dvec3 sum(0);
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x) {
        const vec3 p = image.pixels[static_cast<std::size_t>(y * image.width + x)];
        if (p[c] > 0.75f && p[c] > p[(c + 1) % 3] + 0.3f && p[c] > p[(c + 2) % 3] + 0.3f)
          sum += dvec3(2.0 * x / image.width - 1, 1 - 2.0 * y / image.height, 1);
      }
    EXPECT_GT(sum.z, 0) << "it is in the picture: " << c;
    return sum / sum.z;
  };
  struct Side {
    const char* name;
    int right, up;  // which colour lies farthest there
  };
  for (const char* const scene : {"bare.json", "seen.json"})
    for (const Side& side : {Side{"front", 0, 1}, {"left", 2, 1}, {"top", 0, -1}, {"iso", 0, 1}}) {
      const image::Image image = rendered(scene, {"--look=plain", "--view", side.name, "--size=64"});
      const std::array at = {middle(image, 0), middle(image, 1), middle(image, 2)};
      for (int c = 0; c < 3; ++c) {
        EXPECT_GE(at[static_cast<std::size_t>(side.right)].x, at[static_cast<std::size_t>(c)].x) << side.name;
        if (side.up >= 0) {
          EXPECT_GE(at[static_cast<std::size_t>(side.up)].y, at[static_cast<std::size_t>(c)].y) << side.name;
        } else {
          EXPECT_LE(at[2].y, at[static_cast<std::size_t>(c)].y) << side.name;
        }
      }
    }
  const image::Image upright = rendered("bare.json", {"--look=plain", "--view=front", "--up=z", "--size=64"});
  EXPECT_GT(middle(upright, 2).y, middle(upright, 0).y) << "z is up";
  EXPECT_GT(middle(upright, 0).x, middle(upright, 2).x);
  EXPECT_TRUE(
      fails_with(kdray({"render", folder / "bare.json", "--view=front", "--from=1,2,3"}), 2, "--from"));
}

}  // namespace
}  // namespace kdray::test
