// Records in a file: each comes back as it was written, whatever happened to the others. The oracle is what
// was written.
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <random>

#include "engine/checkpoint/record_file.h"
#include "support/folder.h"

namespace kdray::checkpoint {
namespace {

using test::Folder;

struct RecordTest : testing::Test {
  static constexpr std::uint32_t kRecords = 12;
  Folder folder;
  Header header{
      {hash_of("scene"), hash_of("settings"), hash_of("build"), "settings", "build"}, {64, 64, 8, 8}, "me"};
  std::map<std::uint32_t, std::vector<layout::i64>> written;
  std::vector<std::size_t> ends = {kHeaderBytes};  // of the header, and of each record
  std::string bytes = to_bytes(header);

  void SetUp() override {
    std::mt19937_64 random(7);
    for (std::uint32_t i = 0; i < kRecords; ++i) {
      const RecordId id{i % 3, i, {8 * i, 0, 1 + i % 4, 2}};
      std::vector<layout::i64> sums(id.places.sums());
      for (layout::i64& sum : sums) sum = static_cast<layout::i64>(random());
      append_record(bytes, header.frame(), id, sums, hash_of_sums(sums));
      written[i] = sums;
      ends.push_back(bytes.size());
    }
  }

  RecordFile put(const std::string& content) const {
    const std::filesystem::path path = folder / "a.tiles";
    std::ofstream(path, std::ios::binary) << content;
    return {path, header.frame()};
  }

  // The numbers of the records that are read; each is checked.
  std::vector<std::uint32_t> read(RecordFile& file) const {
    std::vector<std::uint32_t> numbers;
    file.read_on([&](const RecordHead& head, std::uint64_t offset, Sums sums) {
      const std::uint32_t i = head.id.number;
      EXPECT_EQ(std::vector(sums.begin(), sums.end()), written.at(i));
      EXPECT_EQ(head.id.places, (Rectangle{8 * i, 0, 1 + i % 4, 2}));
      std::vector<layout::i64> again(sums.size());
      EXPECT_TRUE(file.load(offset, head.content, again));
      EXPECT_EQ(again, written.at(i));
      numbers.push_back(i);
    });
    return numbers;
  }
};

TEST_F(RecordTest, AllComeBack) {
  RecordFile file = put(bytes);
  EXPECT_EQ(read(file).size(), kRecords);
  EXPECT_EQ(file.damaged(), 0u);
  EXPECT_EQ(file.maker(), "me");
  EXPECT_TRUE(read(file).empty());  // nothing new
}

TEST_F(RecordTest, ATornEndIsLeft) {
  for (std::size_t n = 0; n < bytes.size(); n += 3) {
    RecordFile file = put(bytes.substr(0, n));
    std::size_t whole = 0;
    while (whole < kRecords && ends[whole + 1] <= n) ++whole;
    ASSERT_EQ(read(file).size(), whole) << n;
    ASSERT_EQ(file.damaged(), 0u) << n;
  }
}

TEST_F(RecordTest, WhatIsStillBeingWrittenComesLater) {
  const std::filesystem::path path = folder / "a.tiles";
  RecordFile file(path, header.frame());
  std::size_t n = read(file).size();
  std::ofstream stream(path, std::ios::binary);
  for (std::size_t i = 0; i < bytes.size(); i += 100) {
    stream << bytes.substr(i, 100) << std::flush;
    n += read(file).size();
  }
  EXPECT_EQ(n, kRecords);
  EXPECT_EQ(file.damaged(), 0u);
}

// One bit anywhere costs the record that it is in, and no other.
TEST_F(RecordTest, DamageCostsOneRecord) {
  for (std::size_t i = 0; i < bytes.size(); i += 7) {
    std::string damaged = bytes;
    damaged[i] = static_cast<char>(damaged[i] ^ (1 << i % 8));
    RecordFile file = put(damaged);
    const std::size_t n = read(file).size();
    ASSERT_EQ(n, i < kHeaderBytes ? kRecords : kRecords - 1) << i;
    const bool last = i >= ends[kRecords - 1];
    ASSERT_EQ(file.damaged(), i < kHeaderBytes || last ? 0u : 1u) << i;
  }
}

TEST_F(RecordTest, SoDoBytesThatAreMissingOrRandom) {
  std::mt19937_64 random(11);
  for (int trial = 0; trial < 300; ++trial) {
    std::string damaged = bytes;
    const std::size_t at = ends[3] + 8 * (random() % 8);
    for (std::size_t i = at; i < at + 24; ++i) damaged[i] = static_cast<char>(random());
    RecordFile file = put(damaged);
    EXPECT_EQ(read(file).size(), kRecords - 1);
  }
  RecordFile none = put(std::string(50000, 'k'));
  EXPECT_TRUE(read(none).empty());
}

TEST_F(RecordTest, RecordsOfAnotherFrameAreNone) {
  put(bytes);
  RecordFile file(folder / "a.tiles", hash_of("another"));
  EXPECT_TRUE(read(file).empty());
}

TEST_F(RecordTest, TheFileOfAProcessHoldsWhatItWrote) {
  TileFile out(folder.path(), "owner", header);
  out.append(std::string_view(bytes).substr(kHeaderBytes));
  out.sync_meanwhile();
  out.sync();
  RecordFile file(out.path(), header.frame());
  EXPECT_EQ(read(file).size(), kRecords);
}

TEST_F(RecordTest, AHeaderComesBackWhole) {
  const std::optional<Header> back = header_of(to_bytes(header));
  ASSERT_TRUE(back);
  EXPECT_EQ(back->frame(), header.frame());
  EXPECT_EQ(back->identity.settings_text, "settings");
  for (std::size_t i = 0; i < kHeaderBytes; ++i) {
    std::string damaged = to_bytes(header);
    damaged[i] = static_cast<char>(damaged[i] ^ 16);
    ASSERT_FALSE(header_of(damaged)) << i;
  }
}

}  // namespace
}  // namespace kdray::checkpoint
