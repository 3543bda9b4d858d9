// What    Verdicts that are kept, and marks that outlive the process that made them.
#include "device/opencl/verdicts.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <random>

#include "support/folder.h"

namespace kdray::device {
namespace {

// A key that no other test of this process uses: verdicts are known to the whole process.
Hash new_key() {
  static std::uint64_t n = 0;
  return {0x7e57, ++n};
}

// What another process finds: it says so by its exit status.
template <class Question>
bool elsewhere(Question question) {
  const pid_t child = ::fork();
  if (child == 0) ::_exit(question() ? 0 : 1);
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

TEST(Verdicts, AreKeptBetweenProcesses) {
  const test::Folder folder;
  for (const Verdict& verdict : {Verdict{true, "-DKDRAY_SIMD=1"}, Verdict{true, ""},
                                 Verdict{false, "crashes (SIGSEGV) in the self-test"}}) {
    const Hash key = new_key();
    EXPECT_FALSE(Verdicts(folder.path()).find(key).has_value());
    ASSERT_TRUE(elsewhere([&] {
      Verdicts(folder.path()).note(key, verdict);
      return true;
    }));
    EXPECT_EQ(Verdicts(folder.path()).find(key), verdict);
    EXPECT_FALSE(Verdicts(folder.path()).find(new_key()).has_value());
  }
}

TEST(Verdicts, TheLastOneCounts) {
  const test::Folder folder;
  const Hash key = new_key();
  for (const Verdict& verdict : {Verdict{true, "a"}, Verdict{false, "b"}, Verdict{true, "c"}}) {
    Verdicts(folder.path()).note(key, verdict);
    EXPECT_EQ(Verdicts(folder.path()).find(key), verdict);
    EXPECT_TRUE(elsewhere([&] { return Verdicts(folder.path()).find(key) == verdict; }));
  }
  EXPECT_EQ(folder.n_entries(), 1u);
}

TEST(Verdicts, WithoutAFolderTheProcessKnows) {
  const Hash key = new_key();
  Verdicts().note(key, {false, "hangs"});
  EXPECT_EQ(Verdicts().find(key), (Verdict{false, "hangs"}));
}

TEST(Verdicts, AFolderMayBeReadOnlyOrNotThere) {
  const test::Folder folder;
  folder.put("file", "a file, where a folder is wanted");
  const Verdicts nowhere(folder / "file" / "programs");
  nowhere.note(new_key(), {true, ""});
  const Verdicts reading(folder.path(), false);
  EXPECT_FALSE(reading.keeps());
  reading.note(new_key(), {true, ""});
  EXPECT_EQ(folder.n_entries(), 1u) << "nothing was written";
}

TEST(Verdicts, DamagedOnesAreNone) {
  const test::Folder folder;
  std::mt19937 random(20261124);  // the seed
  for (int i = 0; i < 50; ++i) {
    const Hash key = new_key();
    ASSERT_TRUE(elsewhere([&] {
      Verdicts(folder.path()).note(key, {false, "crashes"});
      return true;
    }));
    const std::string name = std::filesystem::directory_iterator(folder.path())->path().filename().string();
    std::string bytes = folder.get(name);
    bytes[random() % bytes.size()] ^= static_cast<char>(1 + random() % 255);
    folder.put(name, bytes);
    EXPECT_FALSE(Verdicts(folder.path()).find(key).has_value());
    std::filesystem::remove(folder / name);
  }
}

TEST(Marks, AreLeftByAProcessThatEnds) {
  const test::Folder folder;
  const Verdicts verdicts(folder.path());
  const Hash key = new_key();
  {
    const Mark mark(verdicts, key);
    EXPECT_EQ(folder.n_entries(), 1u);
    EXPECT_FALSE(elsewhere([&] { return Mark::is_left(verdicts, key); })) << "its process lives";
    EXPECT_FALSE(elsewhere([&] {
      const Mark second(verdicts, key);
      return folder.n_entries() != 1;
    }));
  }
  EXPECT_EQ(folder.n_entries(), 0u);
  elsewhere([&] {
    const Mark mark(verdicts, key);
    ::raise(SIGKILL);
    return true;
  });
  EXPECT_TRUE(Mark::is_left(verdicts, key));
  EXPECT_FALSE(Mark::is_left(verdicts, new_key()));
  Mark::forget(verdicts, key);
  EXPECT_FALSE(Mark::is_left(verdicts, key));
  EXPECT_EQ(folder.n_entries(), 0u);
}

TEST(Marks, NeedAFolderToBeMade) {
  const Hash key = new_key();
  const Mark mark(Verdicts(), key);
  EXPECT_FALSE(Mark::is_left(Verdicts(), key));
}

}  // namespace
}  // namespace kdray::device
