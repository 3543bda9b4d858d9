#include <gtest/gtest.h>

#include <string>

#include "scene/import/load.h"
#include "scene/model/check_scene.h"
#include "scene/scratch.h"

namespace kdray::scene {
namespace {

const std::string kOff = "OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n";

// With assimp the file loads; without it the refusal says what to install.
TEST(Assimp, ReadsOtherFormatsOrSaysWhatIsMissing) {
  const test::ScratchFolder folder;
  const auto file = folder.write("a.off", kOff);
  try {
    const Scene s = load(file);
    check_scene(s);
    EXPECT_EQ(s.triangles.size(), 2u);
    EXPECT_GE(s.materials.size(), 1u);
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("libassimp-dev"), std::string::npos) << e.what();
  }
}

TEST(Assimp, RefusesRubbishInOneLine) {
  const test::ScratchFolder folder;
  const auto file = folder.write("a.3ds", "rubbish\nin two lines\n");
  EXPECT_NE(test::refusal([&] { load(file); }).find("a.3ds: "), std::string::npos);
}

}  // namespace
}  // namespace kdray::scene
