// Entries that are whole, and entries that are damaged in every way: a damaged one is never taken.
#include "accel/cache/entry.h"

#include <gtest/gtest.h>

#include <cstring>
#include <random>

#include "accel/cache/samples.h"
#include "scene/primitives/kinds.h"
#include "support/errors.h"

namespace kdray::cache {
namespace {

constexpr unsigned kSeed = 41;  // of the places where entries are damaged
constexpr Hash kKey{0x123456789abcdef0, 0x0fedcba987654321};
constexpr std::size_t kPage = 4096;

// The header's checksum lies behind the bytes that it is of; entry.cpp.
// The facts, materials, maps and lights, fourteen arrays of the flat form, the wide form's nodes; each
// shape's own array, and each kind's blocks.
constexpr std::size_t kSections = 1 + 3 + 14 + 1 + (primitives::kKinds - 1) + primitives::kKinds;
constexpr std::size_t kHeaderBytes = 8 + 8 + 8 + 16 + kSections * 40;
constexpr std::size_t kFirstSection = 8 + 8 + 8 + 16;

struct EntryTest : testing::Test {
  test::Folder folder;
  std::filesystem::path file = folder / "entry";
  // All kinds of primitives: tree has cones and spheres on a polygon.
  prepare::Prepared made = test::prepared_from(folder.put("tree.nff", test::nff("tree", 3)));
  std::string whole;

  void SetUp() override {
    write_entry(file, kKey, made);
    whole = folder.get("entry");
  }
  std::optional<prepare::Prepared> read(const std::string& bytes) {
    folder.put("entry", bytes);
    return read_entry(file, kKey);
  }
  // `value` at `offset` of the header, under a right checksum.
  template <class T>
  std::string forged(std::size_t offset, T value) const {
    std::string bytes = whole;
    std::memcpy(bytes.data() + offset, &value, sizeof value);
    const Hash checksum = hash_of(bytes.data(), kHeaderBytes);
    std::memcpy(bytes.data() + kHeaderBytes, &checksum, sizeof checksum);
    return bytes;
  }
  std::uint64_t number_at(std::size_t offset) const {
    std::uint64_t number;
    std::memcpy(&number, whole.data() + offset, sizeof number);
    return number;
  }
};

TEST_F(EntryTest, GivesBackWhatWasWritten) {
  const std::optional<prepare::Prepared> found = read_entry(file, kKey);
  ASSERT_TRUE(found);
  EXPECT_EQ(test::everything(*found), test::everything(made));
  EXPECT_EQ(found->settings.files, made.settings.files);
  EXPECT_EQ(whole.size(), entry_bytes(made));
  EXPECT_GT(made.flat.cones.size(), 0u);
  EXPECT_GT(made.flat.spheres.size(), 0u);
  EXPECT_GT(made.flat.triangles.size(), 0u);
}

TEST_F(EntryTest, GivesBackWhatIsTextured) {
  const prepare::Prepared textured = test::prepared_from(folder.put(
      "a.ply",
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\nelement face 1\nproperty list "
      "uchar int vertex_indices\nend_header\n0 0 0 1 2 3\n1 0 0 4 5 6\n0 1 0 7 8 9\n3 0 1 2\n"));
  ASSERT_EQ(textured.flat.corner_colors.size(), 1u);
  write_entry(file, kKey, textured);
  const std::optional<prepare::Prepared> found = read_entry(file, kKey);
  ASSERT_TRUE(found);
  EXPECT_EQ(test::everything(*found), test::everything(textured));
  ASSERT_EQ(found->flat.corner_colors.size(), 1u);
  EXPECT_EQ(found->settings.texturing.material_maps, textured.settings.texturing.material_maps);
  EXPECT_EQ(found->features, textured.features);
}

TEST_F(EntryTest, ArraysStartAtPagesOfTheMapping) {
  const std::optional<prepare::Prepared> found = read_entry(file, kKey);
  ASSERT_TRUE(found);
  for (const void* data : {static_cast<const void*>(found->flat.nodes.data()),
                           static_cast<const void*>(found->wide.nodes.data()),
                           static_cast<const void*>(found->wide.cone_blocks.data())})
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(data) % kPage, 0u);
  EXPECT_EQ(found->flat.nodes.owner(), found->wide.nodes.owner());
}

TEST_F(EntryTest, OutlivesItsFile) {
  const std::optional<prepare::Prepared> found = read_entry(file, kKey);
  ASSERT_TRUE(found);
  std::filesystem::remove(file);
  EXPECT_EQ(test::everything(*found), test::everything(made));
}

TEST_F(EntryTest, EveryFlippedBitOfTheHeaderIsSeen) {
  for (std::size_t at = 0; at < kHeaderBytes + sizeof(Hash); ++at) {
    std::string bytes = whole;
    bytes[at] = static_cast<char>(bytes[at] ^ 1 << at % 8);
    ASSERT_FALSE(read(bytes)) << "byte " << at;
  }
}

// In every section, at its ends and within; between sections nothing is used, and nothing is lost.
TEST_F(EntryTest, FlippedBitsOfSectionsAreSeen) {
  std::mt19937 random(kSeed);
  const std::string wanted = test::everything(made);
  std::vector<bool> used(whole.size(), false);
  std::vector<std::size_t> places;
  for (std::size_t s = 0; s < kSections; ++s) {
    const std::size_t offset = number_at(kFirstSection + 40 * s), n = number_at(kFirstSection + 40 * s + 8);
    std::fill_n(used.begin() + static_cast<std::ptrdiff_t>(offset), n, true);
    if (n == 0) continue;
    places.insert(places.end(), {offset, offset + n - 1});
    for (int i = 0; i < 20; ++i) places.push_back(offset + random() % n);
  }
  for (int i = 0; i < 200; ++i) places.push_back(kPage + random() % (whole.size() - kPage));
  for (const std::size_t at : places) {
    std::string bytes = whole;
    bytes[at] = static_cast<char>(bytes[at] ^ 1 << random() % 8);
    const std::optional<prepare::Prepared> found = read(bytes);
    ASSERT_EQ(found.has_value(), !used[at]) << "byte " << at;
    if (found) {
      ASSERT_EQ(test::everything(*found), wanted) << "byte " << at;
    }
  }
}

TEST_F(EntryTest, OverwrittenRangesAreSeen) {
  std::mt19937 random(kSeed + 1);
  const std::string wanted = test::everything(made);
  for (int i = 0; i < 200; ++i) {
    std::string bytes = whole;
    const std::size_t at = random() % bytes.size(), n = 1 + random() % (bytes.size() - at);
    for (std::size_t k = at; k < at + n; ++k) bytes[k] = static_cast<char>(random());
    if (const auto found = read(bytes)) {
      ASSERT_EQ(test::everything(*found), wanted) << at << " " << n;
    }
  }
}

TEST_F(EntryTest, CutAndGrownFilesAreSeen) {
  std::mt19937 random(kSeed + 2);
  std::vector<std::size_t> lengths = {0, 1, kHeaderBytes, kPage - 1, kPage, whole.size() - 1};
  for (int i = 0; i < 100; ++i) lengths.push_back(random() % whole.size());
  for (const std::size_t n : lengths) ASSERT_FALSE(read(whole.substr(0, n))) << n << " bytes";
  EXPECT_FALSE(read(whole + '\0'));
  EXPECT_TRUE(read(whole));
}

TEST_F(EntryTest, AHeaderOfAnotherFormIsRefusedUnderARightChecksum) {
  ASSERT_TRUE(read(forged(8, std::uint32_t{9})));  // as it is: the forger knows the form
  EXPECT_FALSE(read(forged(0, 'x'))) << "magic";
  EXPECT_FALSE(read(forged(8, std::uint32_t{8}))) << "an old version";
  EXPECT_FALSE(read(forged(8, std::uint32_t{10}))) << "a new version";
  EXPECT_FALSE(read(forged(12, std::uint32_t{kSections - 1}))) << "fewer sections";
  EXPECT_FALSE(read(forged(16, whole.size() - 1))) << "another size";
  EXPECT_FALSE(read(forged(24, std::uint64_t{7}))) << "another key";
  for (std::size_t s = 0; s < kSections; ++s) {
    const std::size_t at = kFirstSection + 40 * s;
    EXPECT_FALSE(read(forged(at, ~std::uint64_t{0}))) << "a section outside";
    EXPECT_FALSE(read(forged(at + 8, ~std::uint64_t{0} - number_at(at)))) << "a section without end";
  }
  for (std::size_t s = 1; s < kSections; ++s) {
    const std::size_t at = kFirstSection + 40 * s;
    EXPECT_FALSE(read(forged(at + 16, number_at(at + 16) + 1))) << "items of another size";
  }
}

TEST_F(EntryTest, AnotherKeyIsAnotherEntry) {
  EXPECT_FALSE(read_entry(file, {kKey.high, kKey.low + 1}));
}

TEST_F(EntryTest, WhatIsNoFileIsNoEntry) {
  EXPECT_FALSE(read_entry(folder / "missing", kKey));
  EXPECT_FALSE(read_entry(folder.path(), kKey));
}

TEST_F(EntryTest, ThatCannotBeWrittenIsAnInputError) {
  EXPECT_TRUE(test::fails([&] { write_entry(folder / "no/folder/entry", kKey, made); }, "does not exist"));
}

TEST_F(EntryTest, AnEmptySceneIsOneToo) {
  const prepare::Prepared empty = test::prepared_from(
      folder.put("empty.nff", "v\nfrom 0 0 5\nat 0 0 0\nup 0 1 0\nangle 40\nhither 1\nresolution 8 8\n"));
  write_entry(file, kKey, empty);
  const std::optional<prepare::Prepared> found = read_entry(file, kKey);
  ASSERT_TRUE(found);
  EXPECT_EQ(test::everything(*found), test::everything(empty));
}

}  // namespace
}  // namespace kdray::cache
