// Memory beyond its budget lies in files, of which the process holds little, and which nobody else sees.
#include "base/paged.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <limits>
#include <thread>
#include <vector>

#include "base/error.h"
#include "support/patience.h"

namespace kdray {
namespace {

constexpr std::size_t kMebibyte = std::size_t{1} << 20;

// The budget is the process' own, and so a test's, since each runs in a process of its own; here it is put
// back in case they don't.
class Paged : public ::testing::Test {
 protected:
  ~Paged() override {
    set_paged_budget(std::numeric_limits<std::uint64_t>::max());
    ::unsetenv("TMPDIR");
  }
};

// Words that tell their place.
void fill(Array<std::uint64_t>& a, std::uint64_t seed) {
  for (std::size_t i = 0; i < a.size(); ++i) a[i] = i * 0x9e3779b97f4a7c15u + seed;
}
bool holds(const Array<std::uint64_t>& a, std::uint64_t seed) {
  for (std::size_t i = 0; i < a.size(); ++i)
    if (a[i] != i * 0x9e3779b97f4a7c15u + seed) return false;
  return true;
}

// They are written by a thread of their own.
bool comes_below(std::uint64_t bytes) {
  return test::comes_true([&] { return paged_bytes().in_memory <= bytes; });
}

TEST_F(Paged, WhatFitsIsPlain) {
  set_paged_budget(64 * kMebibyte);
  {
    auto a = paged_array<std::uint64_t>(32 * kMebibyte / 8);
    fill(a, 1);
    EXPECT_EQ(paged_bytes().plain, 32 * kMebibyte);
    EXPECT_EQ(paged_bytes().in_files, 0u);
    EXPECT_TRUE(holds(a, 1));
  }
  EXPECT_EQ(paged_bytes().plain, 0u);
}

TEST_F(Paged, WhatDoesNotFitIsInFilesAndStaysWhatItWas) {
  set_paged_budget(16 * kMebibyte);
  {
    std::vector<Array<std::uint64_t>> all;
    for (std::uint64_t k = 0; k < 8; ++k) {
      all.push_back(paged_array<std::uint64_t>(16 * kMebibyte / 8));
      fill(all.back(), k);
    }
    EXPECT_EQ(paged_bytes().in_files, 128 * kMebibyte);
    EXPECT_TRUE(comes_below(4 * kMebibyte));
    for (std::uint64_t k = 0; k < 8; ++k) EXPECT_TRUE(holds(all[k], k)) << k;
    EXPECT_TRUE(comes_below(4 * kMebibyte));
  }
  EXPECT_EQ(paged_bytes().in_files, 0u);
}

// What is written while pages are let go is not lost.
TEST_F(Paged, CanBeWrittenByManyMeanwhile) {
  set_paged_budget(4 * kMebibyte);
  std::vector<Array<std::uint64_t>> all(4);
  std::vector<std::thread> threads;
  std::atomic<int> bad = 0;
  for (std::uint64_t k = 0; k < all.size(); ++k)
    threads.emplace_back([&, k] {
      all[k] = paged_array<std::uint64_t>(8 * kMebibyte / 8);
      for (std::uint64_t round = 0; round < 6; ++round) {
        fill(all[k], k + round);
        if (!holds(all[k], k + round)) ++bad;
      }
    });
  for (std::thread& t : threads) t.join();
  EXPECT_EQ(bad, 0);
}

TEST_F(Paged, FilesHaveNoNames) {
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("kdray_paged_" + std::to_string(::getpid()));
  std::filesystem::create_directory(folder);
  ::setenv("TMPDIR", folder.c_str(), 1);
  set_paged_budget(0);
  const auto a = paged_array<std::uint64_t>(2 * kMebibyte / 8);
  EXPECT_EQ(paged_bytes().in_files, 2 * kMebibyte);
  EXPECT_TRUE(std::filesystem::is_empty(folder));
  std::filesystem::remove(folder);
}

TEST_F(Paged, NoRoomIsToldWhereABudgetWasSet) {
  ::setenv("TMPDIR", "/nowhere", 1);
  set_paged_budget(0);
  try {
    allocate_paged(2 * kMebibyte);
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::input);
    EXPECT_STREQ(e.what(),
                 "/nowhere: no room for 2 MiB of pictures beyond the texture cache: No such file or "
                 "directory; set TMPDIR to a folder with more, or make pictures smaller (--texture-memory)");
  }
}

TEST_F(Paged, SmallOnesAreNotCounted) {
  set_paged_budget(0);
  EXPECT_NE(allocate_paged(100), nullptr);
  EXPECT_EQ(paged_bytes().plain + paged_bytes().in_files, 0u);
}

// A file that somebody else has mapped: pages are let go, the mapping lives as long as it is held.
TEST_F(Paged, LetsGoOfMappedFilesToo) {
  set_paged_budget(8 * kMebibyte);
  const std::size_t n = 32 * kMebibyte;
  const int file = ::open("/var/tmp", O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (file < 0) GTEST_SKIP() << "no nameless file in /var/tmp";
  ASSERT_EQ(::ftruncate(file, static_cast<off_t>(n)), 0);
  void* const memory = ::mmap(nullptr, n, PROT_READ, MAP_PRIVATE, file, 0);
  ::close(file);
  ASSERT_NE(memory, MAP_FAILED);
  bool gone = false;
  {
    const std::shared_ptr<void> paged = page_mapped({memory,
                                                     [&](void* p) {
                                                       gone = true;
                                                       ::munmap(p, n);
                                                     }},
                                                    static_cast<char*>(memory) + 100, n - 100);
    EXPECT_EQ(paged.get(), static_cast<char*>(memory) + 100);
    EXPECT_EQ(paged_bytes().in_files, n - 4096);
    std::uint64_t sum = 0;
    for (std::size_t i = 0; i < n; i += 512) sum += static_cast<const unsigned char*>(memory)[i];
    EXPECT_EQ(sum, 0u);
    EXPECT_TRUE(comes_below(2 * kMebibyte));
    EXPECT_FALSE(gone);
  }
  EXPECT_TRUE(gone);
}

}  // namespace
}  // namespace kdray
