#include "base/write_file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "support/errors.h"
#include "support/folder.h"

namespace kdray {
namespace {

using test::fails;
namespace fs = std::filesystem;

TEST(WriteFile, ReplacesTheWholeContent) {
  const test::Folder folder;
  folder.put("a.txt", "the old, longer content");
  write_file(folder / "a.txt", "new");
  EXPECT_EQ(folder.get("a.txt"), "new");
  EXPECT_EQ(folder.n_entries(), 1u);
}

TEST(WriteFile, LeavesTheOldFileWhenWritingFails) {
  const test::Folder folder;
  folder.put("a.txt", "old");
  const auto fail = [](const fs::path& temporary) {
    write_bytes(temporary, "a.txt", "half of");
    throw std::runtime_error("disk full");
  };
  EXPECT_THROW(write_atomically(folder / "a.txt", fail), std::runtime_error);
  EXPECT_EQ(folder.get("a.txt"), "old");
  EXPECT_EQ(folder.n_entries(), 1u) << "the temporary is still there";
}

TEST(WriteFile, TheTargetAppearsOnlyWhenItIsWhole) {
  const test::Folder folder;
  write_atomically(folder / "a.txt", [&](const fs::path& temporary) {
    EXPECT_FALSE(fs::exists(folder / "a.txt"));
    EXPECT_EQ(temporary.parent_path(), folder.path());
    EXPECT_EQ(temporary.extension(), ".txt");
    write_bytes(temporary, "a.txt", "one ");
    write_bytes(temporary, "a.txt", "two");
  });
  EXPECT_EQ(folder.get("a.txt"), "one two");
}

TEST(WriteFile, PiecesAreWrittenInTheirOrder) {
  const test::Folder folder;
  write_pieces(folder / "a.txt", "a.txt", [](const Sink& sink) {
    sink("one ");
    sink("");
    sink("two");
  });
  EXPECT_EQ(folder.get("a.txt"), "one two");
  const auto to_full = [](std::size_t n_bytes) {
    return [=] {
      write_pieces("/dev/full", "b.txt", [&](const Sink& sink) { sink(std::string(n_bytes, 'x')); });
    };
  };
  for (const std::size_t n_bytes : {std::size_t{1}, std::size_t{1} << 20})
    EXPECT_TRUE(fails(to_full(n_bytes), "b.txt: the disk is full"));
}

TEST(WriteFile, KeepsPermissionsAndFollowsLinks) {
  const test::Folder folder;
  const fs::path file = folder.put("real.txt", "old");
  fs::permissions(file, fs::perms::owner_read | fs::perms::owner_write);
  fs::create_symlink("real.txt", folder / "link.txt");
  write_file(folder / "link.txt", "new");
  EXPECT_TRUE(fs::is_symlink(folder / "link.txt"));
  EXPECT_EQ(folder.get("real.txt"), "new");
  EXPECT_EQ(fs::status(file).permissions(), fs::perms::owner_read | fs::perms::owner_write);
}

TEST(WriteFile, ADeviceIsWrittenNotReplaced) {
  write_file("/dev/null", "nothing");
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
}

TEST(WriteFile, SaysWhatIsWrongWithThePlace) {
  const test::Folder folder;
  folder.put("file", "");
  for (const bool only_check : {false, true}) {
    const auto write = [&](const fs::path& file) {
      return [=] { only_check ? check_writable(file) : write_file(file, "x"); };
    };
    EXPECT_TRUE(fails(write(folder.path()), "is a folder"));
    EXPECT_TRUE(fails(write(folder / "none/a.txt"), "does not exist; make it"));
    EXPECT_TRUE(fails(write(folder / "file/a.txt"), "is not a folder"));
    EXPECT_TRUE(fails(write(folder / "new/"), "is a folder"));
  }
  EXPECT_EQ(folder.n_entries(), 1u);
}

TEST(WriteFile, RefusesWhereItMayNotWrite) {
  if (::geteuid() == 0) GTEST_SKIP() << "root may write everywhere";
  const test::Folder folder;
  const fs::path file = folder.put("a.txt", "old");
  fs::permissions(file, fs::perms::owner_read);
  EXPECT_TRUE(fails([&] { write_file(file, "new"); }, "write-protected"));
  fs::permissions(folder.path(), fs::perms::owner_read | fs::perms::owner_exec);
  EXPECT_TRUE(fails([&] { write_file(folder / "b.txt", "new"); }, "no permission"));
}

TEST(WriteFile, AFullDiskIsSaid) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full";
  EXPECT_TRUE(fails([] { write_file("/dev/full", "x"); }, "the disk is full"));
}

TEST(CheckWritable, LeavesNothingBehind) {
  const test::Folder folder;
  folder.put("old.txt", "old");
  check_writable(folder / "new.txt");
  check_writable(folder / "old.txt");
  EXPECT_EQ(folder.n_entries(), 1u);
  EXPECT_EQ(folder.get("old.txt"), "old");
}

}  // namespace
}  // namespace kdray
