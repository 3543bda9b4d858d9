// Primitives that come from other ranks, and the normals of their zero-area triangles.
#include "cluster/partition/primitive_set.h"

#include <cstring>

#include "fuzz/script.h"

namespace {

using namespace kdray;

// What is announced is allocated, up to gigabytes: of counts that would be, some hundred stay.
void amend_counts(transport::Message& message) {
  constexpr std::size_t kCounts = primitives::kKinds + 1;
  std::uint64_t counts[kCounts];
  if (message.bytes.size() != sizeof counts) return;
  std::memcpy(counts, message.bytes.data(), sizeof counts);
  for (std::uint64_t& n : counts)
    if (n < std::uint64_t{1} << 32) n %= 512;
  std::memcpy(message.bytes.data(), counts, sizeof counts);
}

}  // namespace

KDRAY_FUZZ(partition, bytes) {
  fuzz::Input input(bytes);
  const auto which = input.take<std::uint8_t>();
  const partition::CornerRows rows{which & 1u, which >> 1 & 1u};
  const auto bring = [&](transport::Ranks& ranks) {
    transport::Together all(ranks);
    partition::PrimitiveSet own;
    own.triangles.resize(2);
    for (layout::u32 i = 0; i < 2; ++i) {
      own.triangles[i] = {};
      own.triangles[i].normals = KDRAY_NO_NORMALS;
      own.triangles[i].number = i;
    }
    own.colors.resize(2 * rows.colors);
    own.texcoords.resize(2 * rows.texcoords);
    const std::vector<std::uint32_t> rank_of = {0, 1};
    partition::PrimitiveSet come = partition::bring(std::move(own), rank_of, rows, all);
    for (const layout::Triangle& t : come.triangles)
      if (t.normals != KDRAY_NO_NORMALS && (t.normals & KDRAY_NORMALS_MASK) >= come.normals.size())
        fuzz::fail("a triangle whose normals are not there");
  };
  return fuzz::plays(which >> 2 & 1, 3, input.rest(), transport::kTagsOfShares, bring, amend_counts);
}
