// What    Reads all that is kept for the fuzzers' targets: examples from which libFuzzer goes on, and inputs
//         that it has found a fault with, which is mended.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "fuzz/target.h"

namespace kdray::fuzz {
namespace {

namespace fs = std::filesystem;

const fs::path kCorpus = fs::path(KDRAY_SOURCE_DIR) / "tests/fuzz/corpus";

std::vector<fs::path> kept_for(const std::string& target) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(kCorpus / target)) files.push_back(entry.path());
  std::ranges::sort(files);
  return files;
}

std::string bytes_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

// An input that ends the process is the last one that is named.
class Corpus : public ::testing::TestWithParam<Target> {};

TEST_P(Corpus, IsReadOrRefused) {
  std::size_t n_read = 0;
  for (const fs::path& file : kept_for(GetParam().name)) {
    std::printf("%s\n", file.filename().c_str());
    std::fflush(stdout);
    n_read += GetParam().read(bytes_of(file)) ? 1 : 0;
  }
  EXPECT_GT(n_read, 0u) << "all of it is refused: nothing behind a reader's first checks is tried";
}

INSTANTIATE_TEST_SUITE_P(Fuzz, Corpus, ::testing::ValuesIn(targets()),
                         [](const auto& target) { return std::string(target.param.name); });

// A folder that is of no target is read by nobody.
TEST(Corpora, AreOfTargets) {
  for (const auto& entry : fs::directory_iterator(kCorpus))
    EXPECT_TRUE(fs::exists(kCorpus.parent_path() / (entry.path().filename().string() + ".cpp")))
        << entry.path();
}

}  // namespace
}  // namespace kdray::fuzz
