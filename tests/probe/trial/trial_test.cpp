// What    What a child's end says about a driver, and what a program's arguments ask for.
#include "probe/trial/trial.h"

#include <gtest/gtest.h>
#include <signal.h>

#include <array>

#include "support/variable.h"

namespace kdray::trial {
namespace {

constexpr double kLimit = 15;

Outcome of(const ChildEnd& end, Subject subject = Subject::device) {
  return outcome_of(subject, end, kLimit);
}

ChildEnd reported(const std::string& report) {
  return {.status = 0, .report = report};
}

void expect_failed(const Outcome& outcome, const std::string& text, bool lasting = true) {
  ASSERT_TRUE(outcome.verdict.has_value());
  EXPECT_FALSE(outcome.verdict->passed);
  EXPECT_EQ(outcome.verdict->text, text);
  EXPECT_EQ(outcome.lasting, lasting);
}

TEST(Trial, AReportIsTheVerdict) {
  const Outcome passed = of(reported("begun 1\npassed -DKDRAY_SIMD=2\n"));
  ASSERT_TRUE(passed.verdict.has_value());
  EXPECT_EQ(*passed.verdict, (device::Verdict{true, "-DKDRAY_SIMD=2"}));
  expect_failed(of(reported("begun 1\nfailed fails the self-test: ray 3\n")), "fails the self-test: ray 3");
  EXPECT_FALSE(of(reported("begun 1\nnone the disk is full\n")).verdict.has_value());
}

TEST(Trial, WhatIsReportedCountsHoweverTheProcessEnds) {
  ChildEnd end{.timed_out = true, .report = "begun 1\npassed \n"};
  EXPECT_TRUE(of(end).verdict->passed);
  end = {.signal = SIGSEGV, .report = "begun 1\npassed \n"};
  EXPECT_TRUE(of(end).verdict->passed);
}

TEST(Trial, WhatIsNotReportedIsReadOffTheEnd) {
  const std::string begun = "begun 1\n";
  expect_failed(of({.timed_out = true, .report = begun}), "takes longer than 15 s for the self-test");
  expect_failed(of({.signal = SIGSEGV, .report = begun}), "crashes (SIGSEGV) in the self-test");
  expect_failed(of({.signal = SIGILL, .report = begun + "passed"}), "crashes (SIGILL) in the self-test");
  expect_failed(of({.status = 1, .report = begun}), "ends the program in the self-test");
  expect_failed(of({.timed_out = true, .report = begun}, Subject::driver),
                "takes longer than 15 s to list its devices");
}

TEST(Trial, WhoIsKilledFromOutsideHasNotFailedForGood) {
  for (const int signal : {SIGKILL, SIGTERM, SIGINT})
    expect_failed(of({.signal = signal, .report = "begun 1\n"}),
                  "was stopped by " + signal_name(signal) + " in the self-test", false);
}

TEST(Trial, AProgramThatDoesNotEvenBeginSaysNothing) {
  EXPECT_FALSE(of({.started = false}).verdict.has_value());
  EXPECT_FALSE(of(reported("")).verdict.has_value());
  EXPECT_FALSE(of({.status = 2, .report = "begun 2\n"}).verdict.has_value()) << "another kdray";
  EXPECT_FALSE(of({.timed_out = true}).verdict.has_value());
}

TEST(Trial, TheLimitCanBeChanged) {
  const test::Variable none("KDRAY_TRIAL_SECONDS");
  EXPECT_EQ(time_limit(), 15);
  EXPECT_EQ(time_limit(kGpuTrialSeconds), 60);
  for (const char* const useless : {"", "0", "-1", "nan", "inf", "x", "1e300"}) {
    const test::Variable set("KDRAY_TRIAL_SECONDS", useless);
    EXPECT_EQ(time_limit(), 15) << useless;
  }
  const test::Variable set("KDRAY_TRIAL_SECONDS", "2.5");
  EXPECT_EQ(time_limit(), 2.5);
  EXPECT_EQ(time_limit(kGpuTrialSeconds), 2.5);
}

TEST(Trial, ArgumentsAskForOneOrForNone) {
  const auto asked = [](const std::vector<const char*>& arguments) { return request_of(arguments); };
  const auto device = asked({"kdray", "--try", "device", "0123", "77"});
  ASSERT_TRUE(device.has_value());
  EXPECT_EQ(device->subject, Subject::device);
  EXPECT_EQ(device->key, "0123");
  EXPECT_EQ(device->parent, 77);
  EXPECT_EQ(asked({"kdray", "--try", "driver", "0123", "77"})->subject, Subject::driver);
  EXPECT_EQ(asked({"kdray", "--try", "picture", "0123", "77"})->subject, Subject::picture);
  EXPECT_FALSE(asked({"kdray"}).has_value());
  EXPECT_FALSE(asked({"kdray", "--try", "device", "0123"}).has_value());
  EXPECT_FALSE(asked({"kdray", "--try", "device", "0123", "x"}).has_value());
  EXPECT_FALSE(asked({"kdray", "--try", "luck", "0123", "77"}).has_value());
  EXPECT_FALSE(asked({"kdray", "--tries", "device", "0123", "77"}).has_value());
}

TEST(TrialProgram, TheEnvironmentMayNameIt) {
  {
    const test::Variable set("KDRAY_PROGRAM", KDRAY_PROGRAM);
    EXPECT_EQ(program(), std::filesystem::path(KDRAY_PROGRAM));
  }
  const test::Variable set("KDRAY_PROGRAM", "/none");
  EXPECT_EQ(program(), std::nullopt);
}

TEST(TrialProgram, PathIsSearched) {
  const test::Variable none("KDRAY_PROGRAM");
  const std::filesystem::path folder = std::filesystem::path(KDRAY_PROGRAM).parent_path();
  const test::Variable path("PATH", "/none::" + folder.string());
  const auto found = program();
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->filename(), "kdray");
}

}  // namespace
}  // namespace kdray::trial
