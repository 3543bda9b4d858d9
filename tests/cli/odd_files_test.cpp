// What    Every odd file of the test data through the real program: damaged, unusual and hostile files
//         of other projects' test suites. Each gives a picture or one line that names the file, within
//         bounds of time and memory.
#include <algorithm>
#include <set>

#include "cli/output.h"
#include "cli/program.h"
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

TEST(OddFiles, EachGivesAPictureOrOneLine) {
  KDRAY_NEED_DATA(data_path("odd"));
  KDRAY_NEED_DEVICE();
  const Folder folder;
  int pictures = 0, scenes = 0;
  for (const fs::path& file : odd_files()) {
    const Outcome run = kdray({"render", file, "--size", "16x16", "--quiet", "-o", folder / "odd.png"});
    EXPECT_TRUE(is_picture_or_one_line(run, folder, file)) << file;
    if (is_no_scene(file)) {
      EXPECT_EQ(run.code, 1) << file;
    }
    scenes += !is_no_scene(file);
    pictures += run.code == 0;
    fs::remove(folder / "odd.png");
  }
  EXPECT_EQ(folder.n_entries(), 0u);
  // Most of the scenes are odd, not broken: an importer that refused everything would pass all but this.
  EXPECT_GT(pictures, scenes / 2) << "of " << scenes;
}

}  // namespace
}  // namespace kdray::test
