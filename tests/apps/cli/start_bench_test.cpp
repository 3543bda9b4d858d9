// What    `kdray bench` becomes the program kdray-bench that lies beside kdray: which one is started, with
//         what, and what comes back of it. A script stands in for the program, so that nothing is measured.
#include <csignal>

#include "apps/cli/program.h"
#include "support/folder.h"

namespace kdray::test {
namespace {

namespace fs = std::filesystem;

// A copy of kdray in a folder of its own, with or without a program beside it.
class Installed {
 public:
  Installed() {
    fs::create_directory(folder_ / "bin");
    fs::copy_file(KDRAY_PROGRAM, kdray_path());
  }

  fs::path kdray_path() const { return folder_ / "bin" / "kdray"; }
  fs::path folder() const { return folder_.path(); }

  void put_bench(const std::string& script, fs::perms permissions = fs::perms::owner_all) {
    const fs::path bench = folder_.put("bin/kdray-bench", script);
    fs::permissions(bench, permissions);
  }

  Outcome run(const std::vector<std::string>& arguments) const {
    return kdray(arguments, {.program = kdray_path()});
  }

 private:
  Folder folder_;
};

constexpr const char* kEcho = "#!/bin/sh\nfor a; do echo \"[$a]\"; done\necho heard >&2\nexit 7\n";

TEST(StartBench, ArgumentsGoOnAsTheyAreAndTheStatusComesBack) {
  Installed installed;
  installed.put_bench(kEcho);
  const Outcome run = installed.run({"bench", "rays", "a b.nff", "--", "--no-such", "", "-h"});
  EXPECT_TRUE(run.exited);
  EXPECT_EQ(run.code, 7);
  EXPECT_EQ(run.out, "[rays]\n[a b.nff]\n[--]\n[--no-such]\n[]\n[-h]\n");
  EXPECT_EQ(run.err, "heard\n");
}

TEST(StartBench, HelpBeforeTheCommandIsItsHelp) {
  Installed installed;
  installed.put_bench(kEcho);
  EXPECT_EQ(installed.run({"--help", "bench", "rays"}).out, "[rays]\n[--help]\n");
}

// A signal ends what was started: there is no second process that it would miss.
TEST(StartBench, TheProcessStaysSoThatSignalsArrive) {
  for (const int signal : {SIGINT, SIGTERM, SIGKILL}) {
    Installed installed;
    installed.put_bench("#!/bin/sh\nkill -" + std::to_string(signal) + " $$\nsleep 60\n");
    const Outcome run = installed.run({"bench"});
    EXPECT_FALSE(run.exited);
    EXPECT_EQ(run.signal, signal);
  }
}

TEST(StartBench, IsFoundFromTheProgramItselfWhateverLinkNamesIt) {
  Installed installed;
  installed.put_bench(kEcho);
  const fs::path link = installed.folder() / "linked";
  fs::create_symlink(installed.kdray_path(), link);
  EXPECT_EQ(kdray({"bench", "x"}, {.program = link, .folder = installed.folder()}).out, "[x]\n");
}

TEST(StartBench, AKdrayWithoutItSaysWhatIsMissing) {
  Installed installed;
  EXPECT_TRUE(fails_with(installed.run({"bench", "rays"}), 1, "bin/kdray-bench: no such file"));
  EXPECT_TRUE(succeeds(installed.run({"--help"})));
  installed.put_bench("no program", fs::perms::owner_read);
  EXPECT_TRUE(fails_with(installed.run({"bench", "rays"}), 1, "bin/kdray-bench: can't be run"));
}

}  // namespace
}  // namespace kdray::test
