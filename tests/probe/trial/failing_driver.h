// What    The fixture for drivers that go wrong: this machine's drivers and one of the tests' own
//         (fake_driver.cpp), in a folder of vendors; and what is to come of a device or driver that fails.
#pragma once

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "apps/cli/program.h"
#include "probe/trial/drivers.h"
#include "support/folder.h"
#include "support/patience.h"

namespace kdray::test {

constexpr const char* kName = "Fake device";
// Seconds of a trial, in place of the usual 15: of a driver that hangs, and of others, which a busy machine
// may keep waiting.
constexpr double kLimit = 5;

// Whether a process is there and no zombie.
inline bool lives(int process) {
  std::ifstream in("/proc/" + std::to_string(process) + "/stat");
  std::string number, name, state;
  return in >> number >> name >> state && state != "Z";
}

class DriversThatFail : public testing::Test {
 protected:
  void SetUp() override {
    KDRAY_NEED_DEVICE();
    std::filesystem::create_directory(folder_ / "vendors");
    for (const trial::Driver& d : trial::registered_drivers())
      if (!d.is_library) std::filesystem::copy_file(d.file, folder_ / "vendors" / d.file.filename());
    // What is known of this machine's devices before the other driver is there.
    ASSERT_TRUE(succeeds(run({"devices"}, RunOptions{})));
    register_fake();
    ASSERT_TRUE(succeeds(kdray({"generate", "balls", "--size", "1", "-o", folder_ / "balls.nff"})));
  }

  void register_fake() const { folder_.put("vendors/fake.icd", FAKE_DRIVER_LIBRARY "\n"); }
  void leave_fake_alone() const {
    for (const auto& entry : std::filesystem::directory_iterator(folder_ / "vendors"))
      if (entry.path().filename() != "fake.icd") std::filesystem::remove(entry.path());
  }

  Outcome run(const std::vector<std::string>& arguments, RunOptions options) const {
    const auto wrong = options.environment.find("FAKE_DRIVER");
    const bool hangs = wrong != options.environment.end() && wrong->second.starts_with("hang");
    std::map<std::string, std::string> environment = {
        {"OCL_ICD_VENDORS", (folder_ / "vendors").string()},
        {"KDRAY_CACHE_DIR", (folder_ / "cache").string()},
        {"KDRAY_TRIAL_SECONDS", fmt::format("{}", hangs ? kLimit : kPatience)},
        {"FAKE_DRIVER_LOG", (folder_ / "log").string()},
        {"ASAN_OPTIONS", "handle_segv=0:handle_abort=0:use_sigaltstack=0"}};  // crashes are to be crashes
    for (const auto& [name, value] : options.environment) environment[name] = value;
    options.environment = environment;
    return kdray(arguments, options);
  }
  // The driver goes wrong in this way.
  Outcome run(const std::vector<std::string>& arguments, const std::string& wrong) const {
    return run(arguments, {.environment = {{"FAKE_DRIVER", wrong}}});
  }
  std::vector<std::string> render(std::vector<std::string> more = {}) const {
    std::vector<std::string> arguments = {"render", folder_ / "balls.nff", "--size", "32x32",
                                          "-o",     folder_ / "a.png"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }

  // How often the driver was asked for this.
  std::size_t n_asked(const std::string& where) const { return processes_asked(where).size(); }
  std::vector<int> processes_asked(const std::string& where) const {
    std::vector<int> processes;
    std::istringstream log(folder_.get("log"));
    std::string what;
    for (int process = 0; log >> what >> process;)
      if (what == where) processes.push_back(process);
    return processes;
  }
  std::size_t n_builds() const { return n_asked("build"); }

  testing::AssertionResult all_have_ended() const {
    for (const char* const where : {"load", "list", "build"})
      for (const int process : processes_asked(where)) {
        if (!comes_true([&] { return !lives(process); }))
          return testing::AssertionFailure() << process << " lives";
      }
    return testing::AssertionSuccess();
  }

  // The device is listed as not usable for that reason, at once the next time, and another one renders.
  void expect_left_out(const std::string& wrong, const std::string& why) const {
    SCOPED_TRACE(wrong);
    const Outcome first = run({"devices"}, wrong);
    ASSERT_TRUE(succeeds(first));
    const std::string line = fmt::format("not usable: {} {}", kName, why);
    EXPECT_NE(first.out.find(line), std::string::npos) << first.out;
    const std::size_t builds = n_builds();
    EXPECT_NE(run({"devices"}, wrong).out.find(line), std::string::npos) << "not remembered";
    const Outcome picture = run(render(), wrong);
    EXPECT_TRUE(succeeds(picture));
    EXPECT_NE(picture.err.find(fmt::format("kdray: {} {}", kName, why)), std::string::npos) << picture.err;
    EXPECT_TRUE(std::filesystem::exists(folder_ / "a.png"));
    EXPECT_EQ(n_builds(), builds) << "it was tried again";
    EXPECT_TRUE(all_have_ended());
  }
  // The same for a driver that can't be asked for its devices.
  void expect_driver_left_out(const std::string& wrong, const std::string& why) const {
    SCOPED_TRACE(wrong);
    const Outcome first = run({"devices"}, wrong);
    ASSERT_TRUE(succeeds(first));
    const std::string line = fmt::format("left out: the driver {} (fake.icd) {}", FAKE_DRIVER_LIBRARY, why);
    EXPECT_NE(first.out.find(line), std::string::npos) << first.out;
    EXPECT_EQ(first.out.find(kName), std::string::npos) << first.out;
    const std::size_t loads = n_asked("load");
    EXPECT_NE(run({"devices"}, wrong).out.find(line), std::string::npos) << "not remembered";
    const Outcome picture = run(render(), wrong);
    EXPECT_TRUE(succeeds(picture));
    EXPECT_NE(picture.err.find("(fake.icd) " + why), std::string::npos) << picture.err;
    EXPECT_EQ(n_asked("load"), loads) << "it was tried again";
    EXPECT_TRUE(all_have_ended());
  }

  const Folder folder_;
};

}  // namespace kdray::test
