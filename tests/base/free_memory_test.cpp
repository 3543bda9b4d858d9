// What    How much memory a process may still take, by what the system's files say: version 1 and 2 of
//         control groups, limits of the group itself and of those above it.
#include "base/process_memory.h"

#include <gtest/gtest.h>

#include <fstream>

#include "support/folder.h"

namespace kdray::test {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMiB = std::uint64_t{1} << 20;

// A system of files: 8 GiB are free.
class System {
 public:
  System() { put("proc/meminfo", "MemTotal: 16777216 kB\nMemFree: 1 kB\nMemAvailable: 8388608 kB\n"); }
  void put(const std::string& name, const std::string& text) {
    fs::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name) << text;
  }
  void group_v2(const std::string& name, const std::string& limit, std::uint64_t used,
                std::uint64_t inactive) {
    put("cgroup/" + name + "/memory.max", limit + "\n");
    put("cgroup/" + name + "/memory.current", std::to_string(used) + "\n");
    put("cgroup/" + name + "/memory.stat",
        "anon 5\ninactive_file_x 77\ninactive_file " + std::to_string(inactive) + "\n");
  }
  void group_v1(const std::string& name, std::uint64_t limit, std::uint64_t used, std::uint64_t inactive) {
    put("cgroup/memory/" + name + "/memory.limit_in_bytes", std::to_string(limit) + "\n");
    put("cgroup/memory/" + name + "/memory.usage_in_bytes", std::to_string(used) + "\n");
    put("cgroup/memory/" + name + "/memory.stat",
        "inactive_file 1\ntotal_inactive_file " + std::to_string(inactive) + "\n");
  }
  std::uint64_t free() const { return free_memory({.proc = folder_ / "proc", .cgroup = folder_ / "cgroup"}); }

 private:
  Folder folder_;
};

TEST(FreeMemory, IsTheMachinesWithoutLimits) {
  System system;
  EXPECT_EQ(system.free(), 8192 * kMiB);
  system.put("proc/self/cgroup", "0::/user\n");
  EXPECT_EQ(system.free(), 8192 * kMiB);
  system.group_v2("user", "max", 5, 0);
  EXPECT_EQ(system.free(), 8192 * kMiB);
}

TEST(FreeMemory, IsWhatVersion2LeavesWithoutWhatCanBeDropped) {
  System system;
  system.put("proc/self/cgroup", "0::/user/job\n");
  system.group_v2("user/job", std::to_string(600 * kMiB), 250 * kMiB, 50 * kMiB);
  EXPECT_EQ(system.free(), 400 * kMiB);
  system.group_v2("user/job", std::to_string(600 * kMiB), 700 * kMiB, 0);
  EXPECT_EQ(system.free(), 0u);
}

TEST(FreeMemory, AGroupAboveMayHaveTheLeast) {
  System system;
  system.put("proc/self/cgroup", "0::/user/job/step\n");
  system.group_v2("user/job/step", "max", 10 * kMiB, 0);
  system.group_v2("user/job", std::to_string(600 * kMiB), 10 * kMiB, 0);
  system.group_v2("user", std::to_string(500 * kMiB), 100 * kMiB, 0);
  EXPECT_EQ(system.free(), 400 * kMiB);
}

TEST(FreeMemory, IsWhatVersion1Leaves) {
  System system;
  system.put("proc/self/cgroup", "5:cpu,cpuacct:/other\n4:cpuset,memory:/job\n0::/\n");
  system.group_v1("", 9223372036854771712u, 1000 * kMiB, 0);
  system.group_v1("job", 600 * kMiB, 300 * kMiB, 100 * kMiB);
  EXPECT_EQ(system.free(), 400 * kMiB);
}

TEST(FreeMemory, InAContainerTheRootIsItsOwnGroup) {
  System system;
  system.put("proc/self/cgroup", "4:memory:/docker/0123\n0::/../../x\n");
  system.group_v1("", 700 * kMiB, 100 * kMiB, 0);
  EXPECT_EQ(system.free(), 600 * kMiB);
  system.group_v2("", std::to_string(300 * kMiB), 100 * kMiB, 0);
  EXPECT_EQ(system.free(), 200 * kMiB);
}

TEST(FreeMemory, NothingKnownIsNoLimit) {
  const Folder empty;
  EXPECT_GT(free_memory({.proc = empty.path(), .cgroup = empty.path()}), std::uint64_t{1} << 50);
  EXPECT_GT(free_memory(), 0u);
}

}  // namespace
}  // namespace kdray::test
