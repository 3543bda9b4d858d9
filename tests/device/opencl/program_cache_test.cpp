// What    Programs kept in files: found again or built anew, whatever happens to the files, and never by
//         another key.
#include "device/opencl/program_cache.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <random>
#include <set>
#include <thread>
#include <vector>

#include "base/hash.h"
#include "device/opencl/context.h"
#include "device/opencl/program.h"
#include "support/device.h"
#include "support/errors.h"
#include "support/folder.h"
#include "support/variable.h"

namespace kdray::device {
namespace {

namespace fs = std::filesystem;

constexpr Hash kKey{7, 9};

TEST(ProgramEntry, IsReadAsItWasWritten) {
  const test::Folder folder;
  for (const std::string& bytes : {std::string(), std::string("a\0b", 3), std::string(100000, 'x')}) {
    write_entry(folder / "entry", kKey, bytes);
    EXPECT_EQ(read_entry(folder / "entry", kKey), bytes);
    EXPECT_EQ(read_entry(folder / "entry", {7, 10}), std::nullopt);
  }
  EXPECT_EQ(read_entry(folder / "none", kKey), std::nullopt);
  EXPECT_EQ(read_entry(folder.path(), kKey), std::nullopt);
}

TEST(ProgramEntry, OneThatIsCutOrLongerIsNone) {
  const test::Folder folder;
  write_entry(folder / "entry", kKey, "a binary of some bytes");
  const std::string whole = folder.get("entry");
  for (std::size_t n = 0; n < whole.size(); ++n) {
    folder.put("entry", whole.substr(0, n));
    EXPECT_EQ(read_entry(folder / "entry", kKey), std::nullopt) << n;
  }
  folder.put("entry", whole + "x");
  EXPECT_EQ(read_entry(folder / "entry", kKey), std::nullopt);
}

TEST(ProgramEntry, OneWithAnyFlippedBitIsNone) {
  const test::Folder folder;
  write_entry(folder / "entry", kKey, "a binary");
  const std::string whole = folder.get("entry");
  for (std::size_t bit = 0; bit < 8 * whole.size(); ++bit) {
    std::string damaged = whole;
    damaged[bit / 8] = static_cast<char>(damaged[bit / 8] ^ (1 << bit % 8));
    folder.put("entry", damaged);
    EXPECT_EQ(read_entry(folder / "entry", kKey), std::nullopt) << bit;
  }
}

TEST(ProgramKey, TellsApartWhateverHasASay) {
  std::set<std::string> keys;
  const auto add = [&](const char* identity, const char* source, const char* options) {
    keys.insert(in_hex(program_key(identity, source, options)));
  };
  add("device", "source", "options");
  add("device", "source", "options");
  EXPECT_EQ(keys.size(), 1u);
  add("device with driver 2", "source", "options");
  add("device", "source ", "options");
  add("device", "source", "options -DX");
  add("device", "options", "source");
  add("device\nsource", "", "options");
  add("", "device\nsource", "options");
  EXPECT_EQ(keys.size(), 7u);
}

class ProgramCacheTest : public test::EachDevice {
 protected:
  // What the compiler makes of this adds `n` to each number; another n is another program.
  static std::string source(int n = 1) {
    return "__kernel void add(__global int* x) { x[get_global_id(0)] += " + std::to_string(n) + "; }\n";
  }

  // A cache of its own, as another process has.
  Builds builds() {
    return {std::make_shared<ProgramCache>(folder_.path(), max_bytes_), [this](bool b) { n_compiled_ += b; }};
  }

  cl::Program build(const Builds& builds, int n = 1, const std::string& options = "-cl-std=CL1.2") {
    return build_source(opened().context, opened().devices, "add.cl", source(n), options, builds);
  }

  // Builds, uses, and keeps it; whether a compiler was at work.
  bool compiled(int n = 1, const std::string& options = "-cl-std=CL1.2") {
    n_compiled_ = 0;
    const Builds b = builds();
    EXPECT_EQ(run(build(b, n, options)), n);
    b.cache->keep();
    return n_compiled_ > 0;
  }

  int run(const cl::Program& program) {
    cl::Kernel kernel(program, "add");
    const cl::CommandQueue& queue = opened().queues.front();
    std::vector<cl_int> x(16, 0);
    const cl::Buffer buffer(opened().context, CL_MEM_READ_WRITE, x.size() * sizeof(cl_int));
    queue.enqueueWriteBuffer(buffer, CL_TRUE, 0, x.size() * sizeof(cl_int), x.data());
    kernel.setArg(0, buffer);
    queue.enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(x.size()), cl::NDRange(4));
    queue.enqueueReadBuffer(buffer, CL_TRUE, 0, x.size() * sizeof(cl_int), x.data());
    return x.back();
  }

  const OpenDevice& opened() const { return context_.opened(); }
  fs::path only_entry() const { return fs::directory_iterator(folder_.path())->path(); }

  const Context context_{GetParam(), 1};
  const test::Folder folder_;
  std::uint64_t max_bytes_ = ProgramCache::kMaxBytes;
  int n_compiled_ = 0;
};

TEST_P(ProgramCacheTest, AHitAfterAMiss) {
  EXPECT_TRUE(compiled());
  EXPECT_EQ(folder_.n_entries(), 1u);
  EXPECT_FALSE(compiled());
  EXPECT_EQ(folder_.n_entries(), 1u);
}

TEST_P(ProgramCacheTest, OtherSourceOrOptionsAreAnotherProgram) {
  compiled();
  EXPECT_TRUE(compiled(2));
  EXPECT_TRUE(compiled(1, "-cl-std=CL1.2 -DOTHER"));
  EXPECT_EQ(folder_.n_entries(), 3u);
  EXPECT_FALSE(compiled(2));
}

TEST_P(ProgramCacheTest, PoclsEnvironmentMakesAnotherProgram) {
  compiled();
  const test::Variable variable("POCL_WORK_GROUP_METHOD", "loops");
  EXPECT_TRUE(compiled());
  EXPECT_EQ(folder_.n_entries(), 2u);
}

TEST_P(ProgramCacheTest, DamagedAndForeignEntriesAreReplaced) {
  compiled();
  const fs::path entry = only_entry();
  const std::string name = entry.filename().string(), whole = folder_.get(name);
  std::mt19937 random(20240711);  // the seed
  std::vector<std::string> damaged = {"", "not an entry", whole.substr(0, whole.size() / 2)};
  for (int i = 0; i < 8; ++i) {
    damaged.push_back(whole);
    damaged.back()[random() % whole.size()] ^= static_cast<char>(1 + random() % 255);
  }
  for (const std::string& bytes : damaged) {
    folder_.put(name, bytes);
    EXPECT_TRUE(compiled());
    EXPECT_FALSE(compiled()) << "not replaced";
  }
}

// Right checksum and key, but no binary of this driver's.
TEST_P(ProgramCacheTest, WhatTheDriverRefusesIsReplaced) {
  compiled();
  const Hash key = program_key(identity_of(opened().devices.front()), source(), "-cl-std=CL1.2");
  write_entry(only_entry(), key, std::string(1000, 'z'));
  EXPECT_TRUE(compiled());
  EXPECT_FALSE(compiled());
}

TEST_P(ProgramCacheTest, AFolderThatCannotBeMadeIsNoFailure) {
  folder_.put("file", "a file, where a folder is wanted");
  Builds b = builds();
  b.cache = std::make_shared<ProgramCache>(folder_ / "file" / "programs");
  EXPECT_EQ(run(build(b)), 1);
  EXPECT_EQ(b.cache->keep(), 0u);
}

TEST_P(ProgramCacheTest, AFolderForReadingOnlyIsReadAndNothingElse) {
  compiled();
  fs::permissions(folder_.path(), fs::perms::owner_read | fs::perms::owner_exec);
  if (::access(folder_.path().c_str(), W_OK) == 0) {
    fs::permissions(folder_.path(), fs::perms::owner_all);
    GTEST_SKIP() << "this user may write everywhere";
  }
  EXPECT_FALSE(compiled());
  EXPECT_TRUE(compiled(2));
  fs::permissions(folder_.path(), fs::perms::owner_all);
  EXPECT_EQ(folder_.n_entries(), 1u);
}

TEST_P(ProgramCacheTest, TheLeastRecentlyUsedGoWhereThereIsNoRoom) {
  compiled(1);
  const fs::path first = only_entry();
  max_bytes_ = fs::file_size(first) * 5 / 2;
  compiled(2);
  using Clock = fs::file_time_type::clock;
  for (const auto& entry : fs::directory_iterator(folder_.path()))
    fs::last_write_time(entry.path(), Clock::now() - std::chrono::hours(entry.path() == first ? 1 : 2));
  compiled(3);
  EXPECT_EQ(folder_.n_entries(), 2u);
  EXPECT_TRUE(fs::exists(first));
  EXPECT_FALSE(compiled(1));
}

TEST_P(ProgramCacheTest, PartsOfADeviceShareItsEntries) {
  compiled();
  const Context divided(GetParam(), 2);
  n_compiled_ = 0;
  const Builds b = builds();
  const cl::Program program =
      build_source(divided.get(), divided.opened().devices, "add.cl", source(), "-cl-std=CL1.2", b);
  EXPECT_EQ(n_compiled_, 0);
  for (const cl::CommandQueue& queue : divided.queues()) {
    cl::Kernel kernel(program, "add");
    const cl::Buffer buffer(divided.get(), CL_MEM_READ_WRITE, sizeof(cl_int));
    cl_int x = 41;
    queue.enqueueWriteBuffer(buffer, CL_TRUE, 0, sizeof x, &x);
    kernel.setArg(0, buffer);
    queue.enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(1), cl::NDRange(1));
    queue.enqueueReadBuffer(buffer, CL_TRUE, 0, sizeof x, &x);
    EXPECT_EQ(x, 42);
  }
}

// Each thread has a cache of its own, as processes have.
TEST_P(ProgramCacheTest, SeveralAtOnce) {
  std::vector<Builds> caches;
  for (int i = 0; i < 4; ++i) caches.push_back({std::make_shared<ProgramCache>(folder_.path()), {}});
  {
    std::vector<std::jthread> threads;
    for (int i = 0; i < 4; ++i)
      threads.emplace_back([&, i] {
        for (int n = 1; n <= 3; ++n) (void)build(caches[static_cast<std::size_t>(i)], n);
        caches[static_cast<std::size_t>(i)].cache->keep();
      });
  }
  EXPECT_EQ(folder_.n_entries(), 3u) << "an entry for each program, no temporary left";
  for (int n = 1; n <= 3; ++n) EXPECT_FALSE(compiled(n));
}

TEST_P(ProgramCacheTest, AFailedBuildIsNotKept) {
  const Builds b = builds();
  EXPECT_TRUE(test::fails(
      [&] {
        (void)build_source(opened().context, opened().devices, "broken.cl",
                           "__kernel void f() { no_such(); }", "", b);
      },
      "broken.cl", ErrorCode::no_device));
  EXPECT_EQ(b.cache->keep(), 0u);
}

KDRAY_FOR_EACH_DEVICE(ProgramCacheTest);

}  // namespace
}  // namespace kdray::device
