// What    Every file of the "odd" test data, against the list of what should become of it (odd_files.txt):
//         the number of triangles, or the one line with which it is refused. No file may take much
//         memory, or hang.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <string>

#include "base/error.h"
#include "scene/import/load.h"
#include "support/data.h"

namespace kdray::scene {
namespace {

constexpr long kMostKilobytes = 1 << 20;

std::map<std::string, std::string> read_list() {
  std::ifstream in(test::source_path("tests/scene/odd_files.txt"));
  std::map<std::string, std::string> expected;
  for (std::string line; std::getline(in, line);) {
    const std::size_t tab = line.find('\t');
    if (line.empty() || line[0] == '#') continue;
    EXPECT_NE(tab, std::string::npos) << line;
    const bool is_new = expected.emplace(line.substr(0, tab), line.substr(tab + 1)).second;
    EXPECT_TRUE(is_new) << "listed twice: " << line;
  }
  return expected;
}

std::string outcome(const std::string& file) {
  try {
    return "ok " + std::to_string(load(file).triangles.size());
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::input) << e.what();
    return std::string("error ") + e.what();
  }
}

void expect_outcome(const std::string& file, const std::string& expected) {
  const std::string got = outcome(file);
  EXPECT_EQ(got.find('\n'), std::string::npos) << "not one line: " << got;
  if (!expected.starts_with("error ")) {
    EXPECT_EQ(got, expected) << file;
    return;
  }
  const std::string wanted = "error " + file + expected.substr(6);
  EXPECT_TRUE(got.starts_with(wanted)) << "wanted: " << wanted << "\n   got: " << got;
}

TEST(OddFiles, AreReadOrRefusedAsListed) {
  const auto folder = test::data_path("odd");
  KDRAY_NEED_DATA(folder);
  rusage before{};
  getrusage(RUSAGE_SELF, &before);
  for (const auto& [name, expected] : read_list()) {
    if (expected != "helper") expect_outcome((folder / name).string(), expected);
  }
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  EXPECT_LT(usage.ru_maxrss - before.ru_maxrss, kMostKilobytes);
}

TEST(OddFiles, AreAllListed) {
  const auto folder = test::data_path("odd");
  KDRAY_NEED_DATA(folder);
  std::set<std::string> there;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) there.insert(entry.path().lexically_relative(folder).generic_string());
  }
  std::set<std::string> listed;
  for (const auto& [name, expected] : read_list()) listed.insert(name);
  EXPECT_EQ(there, listed);
}

}  // namespace
}  // namespace kdray::scene
