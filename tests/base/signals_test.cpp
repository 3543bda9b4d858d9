// What    Signals that end the process: what is temporary goes, what is complete stays, and the process dies
//         of the signal.
#include "base/signals.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <optional>
#include <thread>

#include "base/error.h"
#include "base/temporary.h"
#include "base/write_file.h"
#include "support/folder.h"

namespace kdray::test {
namespace {

// The status of a process that does this.
template <class Action>
int status_of(const Action& action) {
  const pid_t child = ::fork();
  if (child == 0) {
    action();
    ::_exit(0);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  return status;
}

[[noreturn]] void get(int signal) {
  ::kill(::getpid(), signal);
  for (;;) std::this_thread::sleep_for(std::chrono::seconds(1));
}

TEST(Signals, AFileInWorkIsRemoved) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) {
    const Folder folder;
    const int status = status_of([&] {
      mind_signals();
      write_atomically(folder / "out.png", [&](const std::filesystem::path& temporary) {
        write_bytes(temporary, "out.png", "half of it");
        get(signal);
      });
    });
    EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == signal) << signal;
    EXPECT_EQ(folder.n_entries(), 0u) << signal;
  }
}

TEST(Signals, WhateverHandlersLibrariesSet) {
  const Folder folder;
  const int status = status_of([&] {
    mind_signals();
    ::signal(SIGQUIT, [](int) {});  // as LLVM does
    get(SIGQUIT);
  });
  EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGQUIT);
}

TEST(Signals, WhatIsCompleteStaysAndFoldersGo) {
  const Folder folder;
  const int status = status_of([&] {
    mind_signals();
    write_file(folder / "whole", "all of it");
    const Temporary cache(folder / "cache");
    std::filesystem::create_directories(cache.path() / "a" / "b");
    std::ofstream(cache.path() / "a" / "b" / "c") << "kept for the moment";
    get(SIGTERM);
  });
  EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGTERM);
  EXPECT_EQ(folder.n_entries(), 1u);
  EXPECT_TRUE(std::filesystem::exists(folder / "whole"));
}

TEST(Signals, WhatIsAParentsStaysWhenItsForkEnds) {
  const Folder folder;
  std::optional<Temporary> parents(std::in_place, folder / "parents");
  std::filesystem::create_directory(parents->path());
  EXPECT_EQ(status_of([&] { parents.reset(); }), 0);
  EXPECT_EQ(status_of([] { remove_temporaries(); }), 0);
  EXPECT_TRUE(std::filesystem::exists(folder / "parents"));
  parents.reset();
  EXPECT_FALSE(std::filesystem::exists(folder / "parents"));
}

TEST(Signals, OneThatIsIgnoredStaysIgnored) {
  const int status = status_of([] {
    ::signal(SIGHUP, SIG_IGN);
    mind_signals();
    ::kill(::getpid(), SIGHUP);
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  });
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << status;
}

TEST(Signals, AFileThatGetsTooLargeIsAnErrorThatIsTold) {
  const Folder folder;
  const int status = status_of([&] {
    mind_signals();
    const rlimit limit{4096, 4096};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    try {
      write_file(folder / "large", std::string(100000, 'x'));
    } catch (const Error& error) {
      ::_exit(std::string(error.what()).find("ulimit -f") == std::string::npos ? 2 : 1);
    }
  });
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 1) << status;
  EXPECT_EQ(folder.n_entries(), 0u);
}

}  // namespace
}  // namespace kdray::test
