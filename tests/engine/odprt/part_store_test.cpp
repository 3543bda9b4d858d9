// What    Parts that come and go: a device holds the one that was asked for, word for word, in buffers that
//         are made once.
#include "engine/odprt/worker_pool.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "engine/odprt/prepared_scenes.h"

namespace kdray::test {
namespace {

using odprt::PartStore;

// The first bytes of a buffer are the array's.
template <class T>
bool holds(cl::CommandQueue& queue, const cl::Buffer& buffer, const Array<T>& items) {
  if (items.empty()) return true;
  std::vector<std::byte> bytes(items.bytes());
  queue.enqueueReadBuffer(buffer, CL_TRUE, 0, bytes.size(), bytes.data());
  return std::memcmp(bytes.data(), items.data(), bytes.size()) == 0;
}

bool holds(cl::CommandQueue& queue, const wavefront::SceneBuffers& b, const odprt::Part& part) {
  bool all = holds(queue, b.normals, part.flat.normals) && holds(queue, b.materials, part.flat.materials) &&
             holds(queue, b.wide_nodes, part.wide.nodes);
  primitives::for_each_kind([&](auto kind) {
    using Kind = decltype(kind);
    all = all && holds(queue, Kind::of(b), Kind::of(part.flat)) &&
          holds(queue, Kind::blocks_of(b), Kind::blocks_of(part.wide));
  });
  return all;
}

TEST(PartStore, HoldsThePartThatWasAskedForLast) {
  const device::Context context("cpu", 1);
  cl::CommandQueue queue = context.queues().front();
  for (const auto& [name, scene] : prepared_scenes()) {
    const odprt::Cut cut = odprt::cut(scene.flat, scene.wide, 64);
    if (cut.subtrees.size() < 5) continue;
    std::vector<double> costs(cut.subtrees.size(), 1.0);
    costs[0] = static_cast<double>(costs.size());  // parts of unequal size
    const odprt::Division division =
        odprt::divide(scene.flat, scene.wide, cut, costs, {.n_parts = 4, .spare = 1});
    const std::size_t bytes = odprt::buffer_bytes(division, false);
    for (const bool streamed : {true, false}) {
      PartStore store(context, queue, division, cut, streamed, false);
      EXPECT_EQ(store.bytes(), 0u);
      for (const std::uint32_t part : {3u, 0u, 1u, 1u, 3u, 2u, 0u}) {
        const odprt::LoadedPart& loaded = store.get(part);
        EXPECT_EQ(loaded.number, part);
        EXPECT_TRUE(holds(queue, loaded.scene, division.parts[part])) << name << " part " << part;
        EXPECT_EQ(store.bytes(), streamed ? bytes : division.parts[part].geometry_bytes());
      }
      EXPECT_EQ(store.n_loads(), 6u) << "one was there already";
    }
    EXPECT_GE(bytes, odprt::largest_bytes(division)) << name;
    EXPECT_LT(bytes, 2 * odprt::largest_bytes(division) + 4096) << name;
  }
}

}  // namespace
}  // namespace kdray::test
