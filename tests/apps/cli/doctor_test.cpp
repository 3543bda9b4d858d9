// What    kdray devices and kdray doctor, with the machine's devices and without any.
#include <nlohmann/json.hpp>

#include "apps/cli/program.h"
#include "apps/cli/scenes.h"
#include "support/folder.h"

namespace kdray::test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

RunOptions vendors(const Folder& folder) {
  return {.environment = {{"OCL_ICD_VENDORS", folder.path().string() + "/"}}};
}

TEST(DevicesCommand, ListsWhatRenderCanUse) {
  KDRAY_NEED_DEVICE();
  const Outcome run = kdray({"devices", "--json"});
  ASSERT_TRUE(succeeds(run));
  const Json list = Json::parse(run.out);
  ASSERT_GE(list.size(), 1u);
  for (std::size_t i = 0; i < list.size(); ++i) {
    EXPECT_EQ(list[i]["number"], i);
    EXPECT_GT(list[i]["compute_units"], 0);
    if (!list[i]["usable"]) continue;
    const auto vectors = list[i]["vectors"].get<std::string>();
    EXPECT_TRUE(vectors == "portable" || vectors == "x86 AVX2" || vectors == "x86 AVX-512") << vectors;
    EXPECT_NE(kdray({"devices"}).out.find("vectors: " + vectors), std::string::npos);
    EXPECT_NE(kdray({"devices"}).out.find(list[i]["platform"].get<std::string>()), std::string::npos);
  }
}

TEST(DevicesCommand, TheEnvironmentAsksForTheFormOfTheVectors) {
  KDRAY_NEED_DEVICE();
  const Outcome portable = kdray({"devices"}, {.environment = {{"KDRAY_SIMD", "portable"}}});
  ASSERT_TRUE(succeeds(portable));
  EXPECT_NE(portable.out.find("vectors: portable"), std::string::npos) << portable.out;
  EXPECT_EQ(portable.out.find("x86 AVX-512"), std::string::npos) << portable.out;
  EXPECT_TRUE(fails_with(kdray({"devices"}, {.environment = {{"KDRAY_SIMD", "neon"}}}), 2, "KDRAY_SIMD"));
}

TEST(DevicesCommand, WithoutADeviceItIsExitCode3) {
  const Folder folder;
  EXPECT_TRUE(fails_with(kdray({"devices"}, vendors(folder)), 3, "doctor"));
  const Outcome json = kdray({"devices", "--json"}, vendors(folder));
  EXPECT_EQ(json.code, 3);
  EXPECT_EQ(Json::parse(json.out), Json::array());
}

TEST(DoctorCommand, FindsAWorkingDeviceWell) {
  KDRAY_NEED_DEVICE();
  const Outcome run = kdray({"doctor"});
  ASSERT_TRUE(succeeds(run));
  EXPECT_NE(run.out.find("[ok]   device 0"), std::string::npos) << run.out;
  EXPECT_NE(run.out.find("picture and rays are right"), std::string::npos) << run.out;
}

TEST(DoctorCommand, SaysThatNoDriverIsRegistered) {
  const Folder folder;
  const Outcome run = kdray({"doctor"}, vendors(folder));
  EXPECT_EQ(run.code, 3);
  EXPECT_NE(run.out.find("no OpenCL driver is registered in " + folder.path().string()), std::string::npos)
      << run.out;
  EXPECT_NE(run.out.find("pocl-opencl-icd"), std::string::npos) << run.out;
  EXPECT_NE(run.out.find("OCL_ICD_VENDORS replaces"), std::string::npos) << run.out;
  EXPECT_EQ(run.err, "kdray: no usable OpenCL device; the lines marked [bad] say why\n");
}

TEST(DoctorCommand, NamesADriverThatDoesNotOpen) {
  const Folder folder;
  folder.put("broken.icd", "libno-such-driver.so.1\n");
  const Outcome run = kdray({"doctor"}, vendors(folder));
  EXPECT_EQ(run.code, 3);
  EXPECT_NE(run.out.find("[bad]  driver libno-such-driver.so.1"), std::string::npos) << run.out;
  EXPECT_NE(run.out.find("broken.icd"), std::string::npos) << run.out;
}

bool has_pocl() {
  return kdray({"doctor"}).out.find("Portable Computing Language") != std::string::npos;
}

// For root, too, nothing can be made in /proc.
const std::map<std::string, std::string> kNoHome = {{"HOME", "/proc/none"}, {"XDG_CACHE_HOME", "/proc/none"}};

TEST(DevicesCommand, PoclHasADeviceWithoutAHome) {
  if (!has_pocl()) GTEST_SKIP() << "no PoCL";
  const Folder folder;
  std::map<std::string, std::string> environment = kNoHome;
  environment["TMPDIR"] = folder.path();
  ASSERT_TRUE(succeeds(kdray({"devices"}, {.environment = environment})));
  EXPECT_EQ(folder.n_entries(), 0u) << "what was temporary stayed";
  environment["KDRAY_CACHE_DIR"] = folder / "own";
  ASSERT_TRUE(succeeds(kdray({"devices"}, {.environment = environment})));
  EXPECT_TRUE(fs::is_directory(folder / "own" / "pocl"));
  for (const char* const unusable : {"", "/proc/none"}) {
    environment["POCL_CACHE_DIR"] = unusable;
    EXPECT_TRUE(succeeds(kdray({"devices"}, {.environment = environment}))) << unusable;
  }
}

// Runs kdray where nothing in these folders may be executed: in a mount namespace of its own.
Outcome without_execution_in(const std::vector<std::string>& folders,
                             const std::vector<std::string>& arguments,
                             const std::map<std::string, std::string>& environment) {
  std::string script;
  for (const std::string& folder : folders) script += "mount -t tmpfs -o noexec tmpfs '" + folder + "' && ";
  std::vector<std::string> all = {"-rm", "sh", "-c", script + "exec \"$@\"", "sh", KDRAY_PROGRAM};
  all.insert(all.end(), arguments.begin(), arguments.end());
  return kdray(all, {.program = "/usr/bin/unshare", .environment = environment});
}

bool can_mount() {
  const Folder folder;
  return without_execution_in({folder.path()}, {"--version"}, {}).code == 0;
}

TEST(DevicesCommand, WhereNothingCanBeWrittenThatIsWhatIsSaid) {
  if (!has_pocl() || !can_mount()) GTEST_SKIP() << "no PoCL, or no file system can be mounted";
  std::map<std::string, std::string> environment = kNoHome;
  environment["TMPDIR"] = "/proc";
  environment["XDG_RUNTIME_DIR"] = "/proc/none";
  const Outcome run = without_execution_in({"/dev/shm"}, {"devices"}, environment);
  EXPECT_EQ(run.code, 3);
  EXPECT_NE(run.err.find("PoCL has no folder to compile in"), std::string::npos) << run.err;
}

// As on many clusters, whose homes are mounted with noexec.
TEST(DevicesCommand, KernelsAreCompiledWhereTheyMayBeExecuted) {
  if (!has_pocl() || !can_mount()) GTEST_SKIP() << "no PoCL, or no file system can be mounted";
  const Folder folder;
  for (const char* const name : {"home", "temporary", "runtime"}) fs::create_directory(folder / name);
  const std::vector<std::string> closed = {folder / "home", folder / "temporary", "/dev/shm"};
  const std::vector<std::string> render = {
      "render", folder.put("ball.nff", kSphereOnSquare), "--size", "8x8", "-o", folder / "a.png"};
  std::map<std::string, std::string> environment = {
      {"HOME", closed[0]}, {"XDG_CACHE_HOME", closed[0]}, {"TMPDIR", closed[1]}};
  environment["XDG_RUNTIME_DIR"] = folder / "runtime";
  EXPECT_TRUE(succeeds(without_execution_in(closed, render, environment)));
  EXPECT_TRUE(fs::exists(folder / "a.png"));
  EXPECT_TRUE(fs::is_empty(folder / "runtime")) << "what was temporary stayed";
  const Outcome doctor = without_execution_in(closed, {"doctor"}, environment);
  EXPECT_NE(doctor.out.find("noexec"), std::string::npos) << doctor.out;
  environment["XDG_RUNTIME_DIR"] = closed[1];
  const Outcome refused = without_execution_in(closed, render, environment);
  EXPECT_EQ(refused.code, 1);
  EXPECT_NE(refused.err.find("noexec"), std::string::npos) << refused.err;
}

TEST(DoctorCommand, TellsOfAKernelCacheThatCannotBeWritten) {
  if (!has_pocl()) GTEST_SKIP() << "no PoCL";
  const Folder folder;
  const fs::path file = folder.put("file", "a file, where a folder is wanted");
  const Outcome run = kdray({"doctor"}, {.environment = {{"POCL_CACHE_DIR", file / "cache"}}});
  EXPECT_TRUE(succeeds(run)) << run.out;
  EXPECT_NE(run.out.find("it is not writable"), std::string::npos) << run.out;
  EXPECT_NE(run.out.find("for this run only; set POCL_CACHE_DIR"), std::string::npos) << run.out;
}

TEST(DoctorCommand, OclIcdVendorsMayNameALibrary) {
  const Folder folder;
  const fs::path library = folder.put("libdriver.so.1", std::string("\x7f"
                                                                    "ELF\x02\x01\0\0",
                                                                    8));
  const Outcome run = kdray({"doctor"}, {.environment = {{"OCL_ICD_VENDORS", library}}});
  EXPECT_NE(run.out.find("[bad]  driver " + library.string() + " (OCL_ICD_VENDORS)"), std::string::npos)
      << run.out;
  EXPECT_EQ(run.out.find("\x7f"), std::string::npos) << run.out;
  const fs::path icd = folder.put("driver.icd", std::string("\x7f"
                                                            "ELF\x02\x01\0\0",
                                                            8));
  const Outcome binary = kdray({"doctor"}, {.environment = {{"OCL_ICD_VENDORS", icd}}});
  EXPECT_NE(binary.out.find("no text with a library's name"), std::string::npos) << binary.out;
}

}  // namespace
}  // namespace kdray::test
