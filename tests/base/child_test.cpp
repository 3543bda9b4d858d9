// What    Programs run as children: what they report, how they end, and that none outlives its time. The
//         programs are shell scripts.
#include "base/child.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <fstream>
#include <thread>
#include <vector>

#include "base/timer.h"
#include "support/folder.h"
#include "support/patience.h"
#include "support/variable.h"

namespace kdray {
namespace {

ChildOptions shell(const std::string& script, double seconds = test::kPatience) {
  return {.program = "/bin/sh", .arguments = {"-c", script}, .limit_seconds = seconds};
}

ChildEnd end_of(const ChildOptions& options) {
  return Child(options).wait();
}

// Whether a process is there and no zombie.
bool lives(pid_t process) {
  std::ifstream in("/proc/" + std::to_string(process) + "/stat");
  std::string number, name, state;
  return in >> number >> name >> state && state != "Z";
}

bool ends(pid_t process) {
  return test::comes_true([&] { return !lives(process); });
}

// The shell's own number, by a script that reports it first.
pid_t process_in(const std::string& report) {
  return static_cast<pid_t>(std::stol(report));
}

TEST(Child, ReportsAndEnds) {
  const ChildEnd end = end_of(shell("echo chatter; echo noise >&2; printf 'a\\nb' >&3; exit 7"));
  EXPECT_TRUE(end.started);
  EXPECT_FALSE(end.timed_out);
  EXPECT_EQ(end.status, 7);
  EXPECT_EQ(end.signal, 0);
  EXPECT_EQ(end.report, "a\nb");
}

TEST(Child, InheritsTheEnvironmentWithSomeOfItSetAnew) {
  const test::Variable kept("KDRAY_TEST_KEPT", "kept"), changed("KDRAY_TEST_CHANGED", "before");
  ChildOptions options = shell("printf %s \"$KDRAY_TEST_KEPT $KDRAY_TEST_CHANGED $KDRAY_TEST_NEW\" >&3");
  options.environment = {{"KDRAY_TEST_CHANGED", "after"}, {"KDRAY_TEST_NEW", "a=b"}};
  EXPECT_EQ(end_of(options).report, "kept after a=b");
}

TEST(Child, DiesOfASignal) {
  const ChildEnd end = end_of(shell("echo begun >&3; kill -SEGV $$"));
  EXPECT_EQ(end.signal, SIGSEGV);
  EXPECT_EQ(end.status, -1);
  EXPECT_EQ(end.report, "begun\n");
}

TEST(Child, NoSignalIsBlockedThoughThisProcessBlocksIt) {
  sigset_t set, before;
  sigemptyset(&set);
  sigaddset(&set, SIGTERM);
  ::pthread_sigmask(SIG_BLOCK, &set, &before);
  const ChildEnd end = end_of(shell("kill -TERM $$; sleep 100000"));
  ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
  EXPECT_EQ(end.signal, SIGTERM);
}

TEST(Child, AProgramThatIsNotThereWasNotStarted) {
  const ChildEnd end = end_of({.program = "/no/such/program"});
  EXPECT_FALSE(end.started);
  EXPECT_FALSE(end.timed_out);
  EXPECT_EQ(end.report, "");
}

TEST(Child, WhatTakesTooLongIsKilledWithAllThatItHasStarted) {
  const ChildEnd end =
      end_of(shell("sleep 100000 & echo $! >&3; trap '' TERM; while :; do sleep 100000; done", 0.3));
  EXPECT_TRUE(end.timed_out);
  EXPECT_TRUE(ends(process_in(end.report)));
}

// All cores are taken, and the child gets a part of one: it takes longer than its limit, and ends by itself.
TEST(Child, TimeThatOthersTakeDoesNotCount) {
  std::atomic<bool> over = false;
  std::vector<std::jthread> others;
  for (unsigned i = 0; i < 4 * std::thread::hardware_concurrency(); ++i)
    others.emplace_back([&] {
      while (!over) continue;
    });
  // It ends when it has used 0.1 s of a core. Where it gets less than its share, it is tried again.
  constexpr double kLimit = 0.25;
  EXPECT_TRUE(test::comes_true([&] {
    const Timer timer;
    const ChildEnd end = end_of(shell(
        "while read -r line </proc/$$/stat; do set -- $line; [ $((${14} + ${15})) -ge 10 ] && exit 3; done",
        kLimit));
    return end.status == 3 && !end.timed_out && timer.seconds() > kLimit;
  }));
  over = true;
}

TEST(Child, OneThatIsBusyForEverIsKilled) {
  EXPECT_TRUE(end_of(shell("while :; do :; done", 0.3)).timed_out);
}

// A grandchild keeps the pipe open.
TEST(Child, ItsEndCountsThoughSomebodyHoldsThePipe) {
  const ChildEnd end = end_of(shell("sleep 100000 & echo $! >&3; exit 3"));
  EXPECT_EQ(end.status, 3);
  EXPECT_TRUE(ends(process_in(end.report)));
}

TEST(Child, SeveralRunAtOnceEachForItsOwnTime) {
  Child slow(shell("sleep 100000", 1.0)), slower(shell("sleep 100000", 1.0)), quick(shell("echo done >&3"));
  EXPECT_TRUE(slow.wait().timed_out);
  EXPECT_TRUE(slower.wait().timed_out);
  EXPECT_EQ(quick.wait().report, "done\n") << "it has ended in time, whenever that is looked at";
}

TEST(Child, LeavesNoZombie) {
  { const Child abandoned(shell("sleep 100000")); }
  end_of(shell("exit 0"));
  end_of(shell("sleep 100000", 0.05));
  EXPECT_EQ(::waitpid(-1, nullptr, WNOHANG), -1);
  EXPECT_EQ(errno, ECHILD);
}

TEST(Child, WhereChildrenAreNotWaitedForTheReportIsAllThatIsKnown) {
  const auto before = ::signal(SIGCHLD, SIG_IGN);
  const ChildEnd end = end_of(shell("echo done >&3"));
  ::signal(SIGCHLD, before);
  EXPECT_TRUE(end.started);
  EXPECT_FALSE(end.timed_out);
  EXPECT_EQ(end.status, -1);
  EXPECT_EQ(end.report, "done\n");
}

TEST(Child, SignalsHaveNames) {
  EXPECT_EQ(signal_name(SIGSEGV), "SIGSEGV");
  EXPECT_EQ(signal_name(SIGABRT), "SIGABRT");
  EXPECT_EQ(signal_name(200), "signal 200");
}

}  // namespace
}  // namespace kdray
