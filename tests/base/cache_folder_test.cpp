#include "base/cache_folder.h"

#include <gtest/gtest.h>

#include <chrono>

#include "support/folder.h"

namespace kdray {
namespace {

using namespace std::chrono_literals;

struct FolderTest : testing::Test {
  test::Folder folder;

  // An entry of 100 bytes that was last used so many minutes ago.
  std::filesystem::path entry(std::uint64_t number, int minutes) {
    const std::filesystem::path file = entry_file(folder.path(), {0, number}, ".scene");
    folder.put(file.filename().string(), std::string(100, 'x'));
    set_age(file, minutes);
    return file;
  }
  static void set_age(const std::filesystem::path& file, int minutes) {
    std::filesystem::last_write_time(file, std::filesystem::file_time_type::clock::now() - minutes * 1min);
  }
};

TEST_F(FolderTest, NamesEntriesByTheirKeys) {
  EXPECT_EQ(entry_file("cache", {0x12, 0xab}, ".scene").string(),
            "cache/000000000000001200000000000000ab.scene");
}

TEST_F(FolderTest, LeastRecentlyUsedGoFirst) {
  const auto a = entry(1, 30), b = entry(2, 10), c = entry(3, 20), d = entry(4, 0);
  shrink_folder(folder.path(), ".scene", 400);
  EXPECT_EQ(folder.n_entries(), 4u);
  shrink_folder(folder.path(), ".scene", 399);
  EXPECT_FALSE(exists(a));
  touch_entry(c);
  shrink_folder(folder.path(), ".scene", 250);
  EXPECT_FALSE(exists(b));
  EXPECT_TRUE(exists(c));
  EXPECT_TRUE(exists(d));
}

TEST_F(FolderTest, OtherFilesAreLeftAlone) {
  for (const char* name : {"notes.txt", "0123.scene", "0123456789abcdef0123456789abcdeX.scene",
                           "0123456789abcdef0123456789abcdef.scene.bak"}) {
    folder.put(name, std::string(1000, 'x'));
    set_age(folder / name, 100000);
  }
  entry(1, 5);
  shrink_folder(folder.path(), ".scene", 0);
  EXPECT_EQ(folder.n_entries(), 4u);
}

TEST_F(FolderTest, EntriesOfAnotherEndingAreLeftAlone) {
  entry(1, 5);
  entry(2, 6);
  shrink_folder(folder.path(), ".program", 0);
  EXPECT_EQ(folder.n_entries(), 2u);
}

TEST_F(FolderTest, WhatKilledWritersLeftIsRemovedAfterAnHour) {
  folder.put(".kdray-1-00000000.scene", "half");
  folder.put(".kdray-2-00000000.scene", "being written");
  folder.put(".kdray-3-00000000.png", "another's");
  set_age(folder / ".kdray-1-00000000.scene", 61);
  set_age(folder / ".kdray-3-00000000.png", 61);
  shrink_folder(folder.path(), ".scene", 1000);
  EXPECT_FALSE(exists(folder / ".kdray-1-00000000.scene"));
  EXPECT_EQ(folder.n_entries(), 2u);
}

TEST_F(FolderTest, AMissingFolderIsNoError) {
  shrink_folder(folder / "missing", ".scene", 0);
  touch_entry(folder / "missing");
  EXPECT_FALSE(exists(folder / "missing"));
}

}  // namespace
}  // namespace kdray
