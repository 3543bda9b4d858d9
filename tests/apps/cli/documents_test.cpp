// What    docs/cli.md knows every command and every option that --help shows, and no option that it
//         doesn't.
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <sstream>

#include "apps/cli/program.h"
#include "support/data.h"

namespace kdray::test {
namespace {

const std::vector<std::string> kCommands = {
    "render",      "view",           "trace",          "info",           "devices",
    "doctor",      "generate",       "compare",        "verify",         "tune",
    "warm-up",     "bench rays",     "bench frames",   "bench build",    "bench depth",
    "bench modes", "bench accuracy", "bench ablation", "bench instances"};

std::string text_of(const std::filesystem::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::vector<std::string> words_of(const std::string& text) {
  std::istringstream in(text);
  return {std::istream_iterator<std::string>(in), {}};
}

std::set<std::string> options_in(const std::string& text) {
  static const std::regex kOption("--[a-z][a-z0-9-]*");
  std::set<std::string> options;
  for (std::sregex_iterator i(text.begin(), text.end(), kOption), end; i != end; ++i)
    options.insert(i->str());
  return options;
}

// The section of a command: from its heading to the next of the same level.
std::string section(const std::string& page, const std::string& command) {
  const std::size_t start = page.find("\n## " + command + "\n");
  if (start == std::string::npos) return "";
  return page.substr(start, page.find("\n## ", start + 1) - start);
}

TEST(Documents, EveryOptionOfHelpIsInTheCommandLinesPage) {
  const std::string page = text_of(source_path("docs/cli.md"));
  ASSERT_FALSE(page.empty());
  const std::string shared = section(page, "Options of several commands");
  ASSERT_FALSE(shared.empty());
  for (const std::string& command : kCommands) {
    if (command.starts_with("bench ") && !has_bench()) continue;
    const std::string own = section(page, command);
    ASSERT_FALSE(own.empty()) << "no section for " << command;
    const std::set<std::string> documented = options_in(own + shared);
    const std::set<std::string> there = options_in(kdray(words_of(command + " --help")).out);
    ASSERT_FALSE(there.empty());
    for (const std::string& option : there) EXPECT_TRUE(documented.count(option)) << command << " " << option;
    for (const std::string& option : options_in(own))
      EXPECT_TRUE(there.count(option)) << command << " has no " << option << ", but its section names it";
  }
}

TEST(Documents, NoLinkInTheUsersPagesIsBroken) {
  static const std::regex kLink("\\]\\(([^)#:]+)(#[^)]*)?\\)");
  for (const char* const name :
       {"README.md", "CONTRIBUTING.md", "CHANGELOG.md", "docs/README.md", "docs/cli.md"}) {
    const std::string page = text_of(source_path(name));
    ASSERT_FALSE(page.empty()) << name;
    for (std::sregex_iterator i(page.begin(), page.end(), kLink), end; i != end; ++i) {
      const auto target = source_path(name).parent_path() / (*i)[1].str();
      EXPECT_TRUE(std::filesystem::exists(target)) << name << " links " << (*i)[1].str();
    }
  }
}

}  // namespace
}  // namespace kdray::test
