// What    Drivers that hang, crash and refuse, beside those of this machine: kdray leaves them out, says so
//         in one line, remembers it, and uses what else there is. A driver of the tests' own
//         (fake_driver.cpp) goes wrong as it is told.
#include "probe/trial/failing_driver.h"

#include <signal.h>

#include <algorithm>
#include <nlohmann/json.hpp>

namespace kdray::test {
namespace {

using Json = nlohmann::json;

TEST_F(DriversThatFail, OneThatHangsInTheSelfTest) {
  expect_left_out("hang-build", "takes longer than 5 s for the self-test");
}

TEST_F(DriversThatFail, OneThatCrashesInTheSelfTest) {
  expect_left_out("crash-build", "crashes (SIGSEGV) in the self-test");
}

TEST_F(DriversThatFail, OneThatAborts) {
  expect_left_out("abort-build", "crashes (SIGABRT) in the self-test");
}

TEST_F(DriversThatFail, OneThatEndsTheProgram) {
  expect_left_out("exit-build", "ends the program in the self-test");
}

TEST_F(DriversThatFail, OneThatRefusesToCompile) {
  expect_left_out("refuse-build",
                  "fails the self-test: the device's compiler refuses common/simd_test.cl: 1 error found");
}

TEST_F(DriversThatFail, OneThatBuildsWhatNobodyCanRun) {
  expect_left_out(
      "", "fails the self-test: making the kernel simd_test: clCreateKernel gave CL_OUT_OF_RESOURCES");
}

TEST_F(DriversThatFail, OneThatHangsWhenItIsAskedForItsDevices) {
  expect_driver_left_out("hang-list", "takes longer than 5 s to list its devices");
}

TEST_F(DriversThatFail, OneThatCrashesWhenItIsAskedForItsDevices) {
  expect_driver_left_out("crash-list", "crashes (SIGSEGV) when it is asked for its devices");
}

TEST_F(DriversThatFail, OneThatCrashesWhenItIsLoaded) {
  expect_driver_left_out("crash-load", "crashes (SIGSEGV) when it is asked for its devices");
}

TEST_F(DriversThatFail, JsonSaysIt) {
  const Outcome device = run({"devices", "--json"}, "crash-build");
  ASSERT_TRUE(succeeds(device));
  const Json list = Json::parse(device.out);
  const auto fake = std::ranges::find_if(list, [](const Json& d) { return d["name"] == kName; });
  ASSERT_NE(fake, list.end());
  EXPECT_FALSE((*fake)["usable"]);
  EXPECT_NE((*fake)["why_not"].get<std::string>().find("crashes"), std::string::npos);
}

TEST_F(DriversThatFail, TheFirstPictureDoesNotWaitForDevicesThatNobodyWants) {
  ASSERT_TRUE(succeeds(run(render({"--device", "cpu"}), "hang-build")));
  EXPECT_EQ(n_builds(), 0u);
}

TEST_F(DriversThatFail, QuietSaysNothing) {
  const Outcome picture = run(render({"-q"}), "crash-build");
  ASSERT_TRUE(succeeds(picture));
  EXPECT_EQ(picture.err, "");
}

TEST_F(DriversThatFail, DeviceInsists) {
  ASSERT_TRUE(succeeds(run({"devices"}, "crash-build")));
  EXPECT_EQ(run(render({"--device", "fake"}), "crash-build").signal, SIGSEGV);
  const Outcome refused = run(render({"--device", "fake"}), "refuse-build");
  EXPECT_TRUE(fails_with(refused, 3, "the device's compiler refuses"));
  EXPECT_NE(run({"devices"}, "").out.find("crashes (SIGSEGV)"), std::string::npos) << "the verdict stays";
}

TEST_F(DriversThatFail, DeviceInsistsOnADriverByItsFile) {
  ASSERT_TRUE(succeeds(run({"devices"}, "crash-list")));
  EXPECT_EQ(run(render({"--device", "fake.icd"}), "crash-list").signal, SIGSEGV);
  EXPECT_TRUE(succeeds(run(render({"--device", "cpu"}), "crash-list")));
}

TEST_F(DriversThatFail, AnotherVersionIsTriedAnew) {
  ASSERT_TRUE(succeeds(run({"devices"}, "crash-build")));
  const std::size_t builds = n_builds();
  const RunOptions upgraded = {.environment = {{"FAKE_DRIVER", "abort-build"}, {"FAKE_DRIVER_VERSION", "2"}}};
  EXPECT_NE(run({"devices"}, upgraded).out.find("crashes (SIGABRT)"), std::string::npos);
  EXPECT_GT(n_builds(), builds);
}

TEST_F(DriversThatFail, ALibraryThatHasChangedIsAskedAnew) {
  std::filesystem::copy_file(FAKE_DRIVER_LIBRARY, folder_ / "libfake.so");
  folder_.put("vendors/fake.icd", (folder_ / "libfake.so").string() + "\n");
  EXPECT_NE(run({"devices"}, "crash-list").out.find("left out"), std::string::npos);
  EXPECT_NE(run({"devices"}, "refuse-build").out.find("left out"), std::string::npos) << "not remembered";
  std::filesystem::last_write_time(folder_ / "libfake.so",
                                   std::filesystem::file_time_type::clock::now() + std::chrono::hours(1));
  EXPECT_EQ(run({"devices"}, "refuse-build").out.find("left out"), std::string::npos);
}

TEST_F(DriversThatFail, DoctorTriesAnewAndNamesThem) {
  ASSERT_TRUE(succeeds(run({"devices"}, "crash-build")));
  const Outcome doctor = run({"doctor"}, "abort-build");
  ASSERT_TRUE(succeeds(doctor)) << "the other devices are all right";
  EXPECT_NE(doctor.out.find(fmt::format("{}: crashes (SIGABRT) in the self-test", kName)), std::string::npos)
      << doctor.out;
  EXPECT_NE(doctor.out.find("the test picture and rays are right"), std::string::npos) << doctor.out;
  EXPECT_NE(run({"devices"}, "").out.find("crashes (SIGABRT)"), std::string::npos) << "a new verdict";
  const Outcome list = run({"doctor"}, "crash-list");
  EXPECT_TRUE(succeeds(list));
  EXPECT_NE(list.out.find("(SIGSEGV) when it is asked for its devices"), std::string::npos) << list.out;
}

TEST_F(DriversThatFail, NothingNeedsToBeRemembered) {
  for (const char* const cache : {"", "/proc/none"}) {
    const Outcome run_without =
        run(render(), {.environment = {{"FAKE_DRIVER", "crash-build"}, {"KDRAY_CACHE_DIR", cache}}});
    EXPECT_TRUE(succeeds(run_without));
    EXPECT_NE(run_without.err.find("crashes (SIGSEGV)"), std::string::npos) << run_without.err;
  }
}

TEST_F(DriversThatFail, NoCacheKnowsWhatIsKnownAndWritesNothing) {
  ASSERT_TRUE(succeeds(run(render({"--no-cache"}), "crash-build")));
  const std::size_t builds = n_builds();
  EXPECT_EQ(builds, 1u);
  ASSERT_TRUE(succeeds(run(render({"--no-cache"}), "crash-build")));
  EXPECT_EQ(n_builds(), builds + 1) << "nothing was written";
  ASSERT_TRUE(succeeds(run(render(), "crash-build")));
  ASSERT_TRUE(succeeds(run(render({"--no-cache"}), "crash-build")));
  EXPECT_EQ(n_builds(), builds + 2) << "it was known";
}

TEST_F(DriversThatFail, SeveralProcessesAtOnce) {
  std::vector<Outcome> runs(4);
  std::vector<std::thread> threads;
  for (Outcome& one : runs) threads.emplace_back([&] { one = run({"devices"}, "crash-build"); });
  for (std::thread& thread : threads) thread.join();
  for (const Outcome& one : runs) {
    EXPECT_TRUE(succeeds(one));
    EXPECT_NE(one.out.find("crashes (SIGSEGV) in the self-test"), std::string::npos) << one.out;
  }
}

TEST_F(DriversThatFail, CtrlCEndsTheTrialToo) {
  const std::map<std::string, std::string> patient = {{"FAKE_DRIVER", "hang-build"},
                                                      {"KDRAY_TRIAL_SECONDS", fmt::format("{}", kPatience)}};
  const Outcome stopped = run(
      {"devices"}, {.environment = patient, .signal = SIGINT, .signal_when = [&] { return n_builds() > 0; }});
  EXPECT_EQ(stopped.signal, SIGINT);
  EXPECT_TRUE(all_have_ended());
  EXPECT_NE(run({"devices"}, "crash-build").out.find("crashes"), std::string::npos) << "that was no verdict";
}

// There is nothing to choose, so the first start goes wrong as the driver does; the next knows better.
TEST_F(DriversThatFail, TheOnlyOneIsSurvivedTheSecondTime) {
  leave_fake_alone();
  EXPECT_EQ(run(render(), "crash-build").signal, SIGSEGV);
  EXPECT_TRUE(fails_with(run(render(), "crash-build"), 3, "crashes (SIGSEGV) in the self-test"));
  const std::size_t builds = n_builds();
  EXPECT_TRUE(fails_with(run(render(), "crash-build"), 3, "crashes (SIGSEGV) in the self-test"));
  EXPECT_EQ(n_builds(), builds);
}

TEST_F(DriversThatFail, TheOnlyOneThatHangsIsToldAfterCtrlC) {
  leave_fake_alone();
  const Outcome stopped =
      run(render(), {.environment = {{"FAKE_DRIVER", "hang-build"}}, .signal = SIGINT, .signal_when = [&] {
                       return n_builds() > 0;
                     }});
  EXPECT_EQ(stopped.signal, SIGINT);
  EXPECT_TRUE(fails_with(run(render(), "hang-build"), 3, "takes longer than 5 s for the self-test"));
}

TEST_F(DriversThatFail, TheOnlyOneMayBeADriverThatCannotBeAsked) {
  leave_fake_alone();
  EXPECT_EQ(run({"devices"}, "crash-list").signal, SIGSEGV);
  const Outcome second = run({"devices"}, "crash-list");
  EXPECT_EQ(second.code, 3);
  EXPECT_NE(second.out.find("crashes (SIGSEGV) when it is asked for its devices"), std::string::npos)
      << second.out;
  EXPECT_TRUE(fails_with(run(render(), "crash-list"), 3, "crashes (SIGSEGV) when it is asked"));
}

}  // namespace
}  // namespace kdray::test
