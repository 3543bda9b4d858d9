#include "distribute/scene_hash.h"

#include <array>
#include <string>

#include "primitives/kinds.h"

namespace kdray::distribute {

namespace {

template <class T>
void append(std::string& bytes, const T* first, std::size_t n) {
  bytes.append(reinterpret_cast<const char*>(first), n * sizeof(T));
}

void add(Hash& sum, std::string_view bytes) {
  const Hash one = hash_of(bytes);
  sum.high += one.high;
  sum.low += one.low;
}

// But for where its normals are, which is another place in another division.
void append_triangle(std::string& bytes, const flatten::FlatScene& flat, std::size_t i) {
  layout::Triangle t = flat.triangles[i];
  const layout::u32 normals = t.normals & KDRAY_NORMALS_MASK;
  if (t.normals != KDRAY_NO_NORMALS) {
    append(bytes, &flat.normals[normals], 1);
    t.normals &= KDRAY_STITCH;
  }
  append(bytes, &t, 1);
  const auto append_rows = [&](const auto& rows) {
    const std::size_t each = rows.size() / flat.triangles.size();
    append(bytes, rows.data() + i * each, each);
  };
  append_rows(flat.corner_colors);
  append_rows(flat.texcoords);
}

Hash sum_of_primitives(const flatten::FlatScene& flat) {
  Hash sum;
  std::string bytes;
  primitives::for_each_kind([&](auto kind) {
    using Kind = decltype(kind);
    for (std::size_t i = 0; i < Kind::of(flat).size(); ++i) {
      bytes.assign(1, static_cast<char>(Kind::kNumber));
      if constexpr (Kind::kIsShape) {
        append(bytes, &Kind::of(flat)[i], 1);
      } else {
        append_triangle(bytes, flat, i);
      }
      add(sum, bytes);
    }
  });
  return sum;
}

}  // namespace

Hash scene_hash(const flatten::FlatScene& flat, transport::Together& all) {
  const Hash primitives = all.join_values(sum_of_primitives(flat), [](Hash& sum, const Hash& one) {
    sum.high += one.high;
    sum.low += one.low;
  });
  std::string bytes;
  append(bytes, &primitives, 1);
  append(bytes, flat.materials.data(), flat.materials.size());
  append(bytes, flat.coats.data(), flat.coats.size());
  append(bytes, flat.textures.data(), flat.textures.size());
  append(bytes, flat.texels.data(), flat.texels.size());
  append(bytes, flat.lights.data(), flat.lights.size());
  append(bytes, flat.sky.data(), flat.sky.size());
  append(bytes, flat.sky_colors.data(), flat.sky_colors.size());
  return hash_of(bytes);
}

}  // namespace kdray::distribute
