// What    Every odd file of the test data through the real program: damaged, unusual and hostile files
//         of other projects' test suites. Each gives a picture or one line that names the file, within
//         bounds of time and memory.
#include <algorithm>
#include <set>

#include "apps/cli/output.h"
#include "apps/cli/program.h"
#include "scene/pictures.h"
#include "support/data.h"
#include "support/folder.h"

namespace kdray::test {
namespace {

namespace fs = std::filesystem;

constexpr long kPeakKib = 1 << 20;  // 1 GiB

std::vector<fs::path> odd_files() {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(data_path("odd")))
    if (entry.is_regular_file()) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

// Parts of scenes and notes that lie beside them: never scenes themselves.
bool is_no_scene(const fs::path& file) {
  static const std::set<std::string> kEndings = {".mtl", ".bin", ".png", ".jpg", ".txt", ".md"};
  return kEndings.count(cli::ending_of(file)) > 0;
}

::testing::AssertionResult is_picture_or_one_line(const Outcome& run, const Folder& folder,
                                                  const fs::path& file) {
  if (!run.exited)
    return ::testing::AssertionFailure()
           << "killed by signal " << run.signal << " after " << run.seconds << " s";
  if (run.peak_kib > kPeakKib) return ::testing::AssertionFailure() << run.peak_kib << " KiB at most";
  const bool written = fs::exists(folder / "odd.png");
  if (run.code == 0 && written && run.err.empty()) return ::testing::AssertionSuccess();
  if (run.code == 0)
    return ::testing::AssertionFailure() << "exit code 0 with picture " << written << ": " << run.err;
  if (written) return ::testing::AssertionFailure() << "failed, but left a picture: " << run.err;
  // The file itself, or one beside it that it wants and that is missing.
  const bool wants_another = run.err.find("no such file") != std::string::npos;
  return fails_with(run, 1, wants_another ? file.parent_path().string() : file.filename().string());
}

// With a cache, as users have one: compiling a program for each file's features takes longer than all else.
TEST(OddFiles, EachGivesAPictureOrOneLine) {
  KDRAY_NEED_DATA(data_path("odd"));
  KDRAY_NEED_DEVICE();
  const Folder folder;
  int pictures = 0, scenes = 0;
  for (const fs::path& file : odd_files()) {
    const Outcome run = kdray({"render", file, "--size", "16x16", "--quiet", "-o", folder / "odd.png"},
                              {.environment = {{"KDRAY_CACHE_DIR", folder / "cache"}}});
    EXPECT_TRUE(is_picture_or_one_line(run, folder, file)) << file;
    if (is_no_scene(file)) {
      EXPECT_EQ(run.code, 1) << file;
    }
    scenes += !is_no_scene(file);
    pictures += run.code == 0;
    fs::remove(folder / "odd.png");
  }
  EXPECT_EQ(folder.n_entries(), 1u);  // the cache
  // Most of the scenes are odd, not broken: an importer that refused everything would pass all but this.
  EXPECT_GT(pictures, scenes / 2) << "of " << scenes;
}

// A square that is red by a picture of another folder, or by the colours of its corners.
std::string red_square(bool by_picture) {
  const std::string head = "ply\nformat ascii 1.0\n",
                    place = "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n";
  const std::string faces = "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  const std::string of_corners = by_picture
                                     ? "property float u\nproperty float v\n"
                                     : "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  const std::string more = by_picture ? " 0.5 0.5\n" : " 255 0 0\n";
  std::string text =
      head + (by_picture ? "comment TextureFile ..\\textures\\Red.png\n" : "") + place + of_corners + faces;
  for (const std::string corner : {"0 0 0", "1 0 0", "1 1 0", "0 1 0"}) text += corner + more;
  return text + "4 0 1 2 3\n";
}

// One of the file's own folder is not looked at without being asked for.
TEST(OddFiles, AssetRootAllowsThePicturesOfAnotherFolder) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  fs::create_directories(folder / "scenes");
  fs::create_directories(folder / "textures");
  folder.put("textures/red.png", png(1, 1, 3, {255, 0, 0}));
  folder.put("scenes/picture.ply", red_square(true));
  folder.put("scenes/corners.ply", red_square(false));
  const auto render = [&](const std::string& scene, const std::string& out,
                          const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"render", "scenes/" + scene, "--size", "16x16", "-o", out};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return kdray(arguments, {.folder = folder.path()});
  };
  const Outcome without = render("picture.ply", "grey.png", {});
  ASSERT_TRUE(succeeds(without));
  EXPECT_NE(without.err.find(
                "no picture '..\\textures\\Red.png'; put it beside the scene; --asset-root DIR allows"),
            std::string::npos)
      << without.err;
  const Outcome with = render("picture.ply", "red.png", {"--asset-root", "textures"});
  ASSERT_TRUE(succeeds(with));
  EXPECT_EQ(with.err.find("picture '"), std::string::npos) << with.err;
  ASSERT_TRUE(succeeds(render("corners.ply", "corners.png", {})));
  const auto differ = [&](const std::string& a, const std::string& b) {
    return kdray({"compare", folder / a, folder / b, "--max-rmse", "0"}).code;
  };
  EXPECT_EQ(differ("red.png", "corners.png"), 0);
  EXPECT_NE(differ("red.png", "grey.png"), 0);
  EXPECT_TRUE(fails_with(render("picture.ply", "no.png", {"--asset-root", "none"}), 2, "is no folder"));
}

TEST(OddFiles, AnEmptySceneIsRenderedAndSaysSo) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  const Outcome run =
      kdray({"render", folder.put("none.stl", "solid\nendsolid\n"), "--size", "8x8", "-o", folder / "a.png"});
  ASSERT_TRUE(succeeds(run));
  EXPECT_NE(run.err.find("none.stl: there are no surfaces in it: nothing of it will be seen"),
            std::string::npos)
      << run.err;
}

}  // namespace
}  // namespace kdray::test
