#include "accel/flatten/scene_hash.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <string>
#include <vector>

#include "scene/primitives/kinds.h"

namespace kdray::flatten {

namespace {

template <class T>
void append(std::string& bytes, const T* first, std::size_t n) {
  bytes.append(reinterpret_cast<const char*>(first), n * sizeof(T));
}

// Appends all but the place of its normals, which depends on how the scene is divided.
void append_triangle(std::string& bytes, const FlatScene& flat, std::size_t i) {
  layout::Triangle t = flat.triangles[i];
  const layout::u32 normals = t.normals & KDRAY_NORMALS_MASK;
  if (t.normals != KDRAY_NO_NORMALS) {
    append(bytes, &flat.normals[normals], 1);
    t.normals &= KDRAY_ZERO_AREA;
  }
  append(bytes, &t, 1);
  const auto append_rows = [&](const auto& rows) {
    const std::size_t each = rows.size() / flat.triangles.size();
    append(bytes, rows.data() + i * each, each);
  };
  append_rows(flat.corner_colors);
  append_rows(flat.texcoords);
}

// Hashes the primitives of a kind from `first` to before `end`.
template <class Kind>
Hash hash_of_some(Kind, const FlatScene& flat, std::size_t first, std::size_t end) {
  Hash sum;
  std::string bytes;
  for (std::size_t i = first; i < end; ++i) {
    bytes.assign(1, static_cast<char>(Kind::kNumber));
    if constexpr (Kind::kIsShape) {
      append(bytes, &Kind::of(flat)[i], 1);
    } else {
      append_triangle(bytes, flat, i);
    }
    add(sum, hash_of(bytes));
  }
  return sum;
}

// Returns where the arrays begin that have something for each primitive, or are the tree's. An empty one may
// lie where another begins.
std::vector<const void*> arrays_hashed_apart(const FlatScene& flat) {
  std::vector<const void*> firsts;
  const auto add_array = [&](const auto& array) {
    if (!array.empty()) firsts.push_back(array.data());
  };
  add_array(flat.nodes), add_array(flat.refs), add_array(flat.normals);
  add_array(flat.corner_colors), add_array(flat.texcoords);
  primitives::for_each_kind([&](auto kind) { add_array(decltype(kind)::of(flat)); });
  return firsts;
}

}  // namespace

Hash hash_of_primitives(const FlatScene& flat) {
  Hash sum;
  primitives::for_each_kind([&](auto kind) {
    constexpr std::size_t kGrain = 4096;
    add(sum, tbb::parallel_reduce(
                 tbb::blocked_range<std::size_t>(0, decltype(kind)::of(flat).size(), kGrain), Hash{},
                 [&](const tbb::blocked_range<std::size_t>& range, Hash so_far) {
                   add(so_far, hash_of_some(kind, flat, range.begin(), range.end()));
                   return so_far;
                 },
                 [](Hash a, const Hash& b) {
                   add(a, b);
                   return a;
                 }));
  });
  return sum;
}

Hash scene_hash(const Hash& primitives, const FlatScene& flat) {
  const std::vector<const void*> apart = arrays_hashed_apart(flat);
  std::vector<Hash> hashes = {primitives};
  std::uint64_t number = 0;  // of the array
  for_each_flat_array(flat, [&](const auto& array) {
    ++number;
    if (array.empty() || std::ranges::find(apart, array.data()) != apart.end()) return;
    hashes.push_back({number, 0});
    hashes.push_back(hash_of(array.data(), array.bytes()));
  });
  return hash_of(hashes.data(), hashes.size() * sizeof(Hash));
}

}  // namespace kdray::flatten
