#include "cluster/partition/primitive_set.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <span>
#include <utility>

#include "cluster/transport/together.h"
#include "scene/model/check_scene.h"
#include "scene/model/zero_area.h"
#include "scene/primitives/shape_tools.h"

namespace kdray::partition {

namespace {

using transport::Bytes, transport::WireReader, transport::WireWriter;

// Appends the slice's rows of an array that has as many for each of n triangles, or none.
template <class T>
void add_rows(RawVector<T>& rows, const Array<T>& all, std::size_t n, const Slice& slice) {
  const std::size_t each = n == 0 ? 0 : all.size() / n;
  rows.insert(rows.end(), all.begin() + slice.first * each, all.begin() + slice.last * each);
}

bool is_bare(const scene::Scene& scene, const scene::Geometry& geometry, std::size_t i) {
  return scene::is_zero_area(geometry.triangles[i]) &&
         scene.triangles[geometry.sources[i]].normal[0] == scene::kNone;
}

void add_triangles(PrimitiveSet& set, const scene::Scene& scene, const scene::Geometry& geometry,
                   const flatten::FlatScene& flat, const Slice& slice) {
  for (std::size_t i = slice.first; i < slice.last; ++i) {
    layout::Triangle t = flat.triangles[i];
    if (is_bare(scene, geometry, i))
      set.bare_zero_area.push_back(static_cast<std::uint32_t>(set.triangles.size()));
    if (t.normals != KDRAY_NO_NORMALS) {
      const auto place = static_cast<layout::u32>(set.normals.size());
      set.normals.push_back(flat.normals[t.normals & KDRAY_NORMALS_MASK]);
      t.normals = (t.normals & KDRAY_ZERO_AREA) | place;
    }
    set.triangles.push_back(t);
  }
  add_rows(set.colors, flat.corner_colors, flat.triangles.size(), slice);
  add_rows(set.texcoords, flat.texcoords, flat.triangles.size(), slice);
}

}  // namespace

void add_slice(PrimitiveSet& set, const scene::Scene& scene, const scene::Geometry& geometry,
               const flatten::FlatScene& flat, int rank, int size) {
  add_triangles(set, scene, geometry, flat, slice_of(flat.triangles.size(), rank, size));
  primitives::for_each_shape([&](auto kind) {
    using Kind = decltype(kind);
    const auto& shapes = Kind::of(geometry);
    const Slice slice = slice_of(shapes.size(), rank, size);
    for (std::size_t i = slice.first; i < slice.last; ++i) {
      const auto& packed = Kind::of(flat)[i];
      Kind::of(set).push_back({shapes[i], packed.number, packed.material});
    }
  });
}

namespace {

constexpr std::size_t kGrainOfZeroArea = std::size_t{1} << 14;

using Triangles = std::vector<layout::Triangle>;

// Returns the zero-area triangles of all ranks, in the order of the file.
Triangles gather_zero_area(const PrimitiveSet& set, transport::Together& all) {
  std::vector<layout::Triangle> own;
  for (const layout::Triangle& t : set.triangles)
    if (scene::is_zero_area(t)) own.push_back(t);
  const auto parts = all.gather(transport::bytes_of_list(std::span<const layout::Triangle>(own)));
  Triangles zero_area;
  for (int from = 0; from < all.size(); ++from) {
    const Bytes& part = parts[static_cast<std::size_t>(from)];
    WireReader reader(part, from);
    reader.take(zero_area, part.size() / sizeof(layout::Triangle));
    reader.end();
  }
  return zero_area;
}

const layout::Triangle& triangle_of(const PrimitiveSet& set, std::uint32_t number) {
  return *std::ranges::lower_bound(set.triangles, number, {}, &layout::Triangle::number);
}

// Returns each side's neighbour's normal, which comes from the rank that has the neighbour.
std::vector<vec3> normals_of_neighbours(const PrimitiveSet& set, scene::ZeroAreaSides& sides,
                                        transport::Together& all) {
  const std::vector<std::uint32_t> own(sides.neighbours().begin(), sides.neighbours().end());
  all.join_lists(sides.neighbours(),
                 [](std::uint32_t& least, std::uint32_t one) { least = std::min(least, one); });
  std::vector<vec3> normals(own.size(), vec3(0));
  for (std::size_t i = 0; i < own.size(); ++i)
    if (own[i] != scene::ZeroAreaSides::kNobody && own[i] == sides.neighbours()[i])
      normals[i] = scene::ZeroAreaSides::normal_of(triangle_of(set, own[i]));
  all.join_lists(std::span<vec3>(normals), [](vec3& sum, const vec3& one) {
    if (sum == vec3(0)) sum = one;
  });
  return normals;
}

}  // namespace

void settle_zero_area(PrimitiveSet& set, transport::Together& all) {
  const Triangles zero_area = gather_zero_area(set, all);
  scene::ZeroAreaSides sides(zero_area);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, set.triangles.size(), kGrainOfZeroArea),
                    [&](const auto& range) {
                      for (std::size_t i = range.begin(); i < range.end(); ++i)
                        sides.meet(set.triangles[i], set.triangles[i].number);
                    });
  const std::vector<vec3> neighbours = normals_of_neighbours(set, sides, all);
  const std::vector<vec3> normals = sides.normals([&](std::size_t side) { return neighbours[side]; });
  for (const std::uint32_t place : set.bare_zero_area) {
    const layout::Triangle& t = set.triangles[place];
    const auto found = std::ranges::lower_bound(zero_area, t.number, {}, &layout::Triangle::number);
    const vec3& normal = normals[static_cast<std::size_t>(found - zero_area.begin())];
    for (auto& at_corner : set.normals[t.normals & KDRAY_NORMALS_MASK].n) primitives::set(at_corner, normal);
  }
  set.bare_zero_area.clear();
}

namespace {

constexpr std::size_t kBatchOfPrimitives = std::size_t{1} << 16;  // primitives of a kind

struct Counts {
  std::array<std::uint64_t, primitives::kKinds> of{};
  std::uint64_t normals = 0;
  bool operator==(const Counts&) const = default;
};

bool has_normals(const layout::Triangle& t) {
  return t.normals != KDRAY_NO_NORMALS;
}

class Carrier {
 public:
  Carrier(PrimitiveSet set, std::span<const std::uint32_t> rank_of, const CornerRows& rows,
          transport::Together& all)
      : set_(std::move(set)), rank_of_(rank_of), rows_(rows), all_(all) {}

  PrimitiveSet carry() {
    count_arrivals();
    std::size_t first = 0;  // of the kind, in rank_of_
    primitives::for_each_kind([&](auto kind) {
      const std::size_t n = decltype(kind)::of(set_).size();
      const std::size_t n_rounds = all_.most((n + kBatchOfPrimitives - 1) / kBatchOfPrimitives);
      for (std::size_t round = 0; round < n_rounds; ++round) {
        const std::size_t begin = std::min(n, round * kBatchOfPrimitives),
                          end = std::min(n, begin + kBatchOfPrimitives);
        exchange(kind, first, begin, end);
      }
      first += n;
    });
    for (std::size_t from = 0; from < n_ranks(); ++from)
      if (next_[from] != end_[from]) transport::throw_odd_message(static_cast<int>(from));
    return std::move(here_);
  }

 private:
  std::size_t n_ranks() const { return static_cast<std::size_t>(all_.size()); }

  // How many of each kind come from whom, and so where they go.
  void count_arrivals() {
    std::vector<Counts> out(n_ranks());
    std::size_t i = 0;
    primitives::for_each_kind([&](auto kind) {
      for (const auto& item : decltype(kind)::of(set_)) {
        Counts& counts = out[rank_of_[i++]];
        ++counts.of[kind.kNumber];
        if constexpr (!decltype(kind)::kIsShape) counts.normals += has_normals(item) ? 1 : 0;
      }
    });
    std::vector<Bytes> messages(n_ranks());
    for (std::size_t to = 0; to < n_ranks(); ++to) WireWriter(messages[to]).put(out[to]);
    messages = all_.exchange(std::move(messages));
    Counts sum;
    for (std::size_t from = 0; from < n_ranks(); ++from) {
      const Counts counts = counts_of(messages[from], static_cast<int>(from));
      next_.push_back(sum);
      for (std::size_t kind = 0; kind < sum.of.size(); ++kind) sum.of[kind] += counts.of[kind];
      sum.normals += counts.normals;
      end_.push_back(sum);
    }
    check(sum);
    const std::size_t n_triangles = sum.of[KDRAY_KIND_TRIANGLE];
    here_.normals.resize(sum.normals);
    here_.colors.resize(n_triangles * rows_.colors);
    here_.texcoords.resize(n_triangles * rows_.texcoords);
    primitives::for_each_kind([&](auto kind) { decltype(kind)::of(here_).resize(sum.of[kind.kNumber]); });
  }

  // Each is checked by itself as well: the sum of any counts might be one that fits.
  static Counts counts_of(const Bytes& message, int from) {
    WireReader reader(message, from);
    const auto counts = reader.get<Counts>();
    reader.end();
    check(counts);
    if (counts.normals > counts.of[KDRAY_KIND_TRIANGLE]) transport::throw_odd_message(from);
    return counts;
  }

  static void check(const Counts& sum) {
    for (const std::uint64_t n : sum.of)
      if (n >= scene::kMaxPrimitivesPerKind)
        throw Error(ErrorCode::input, "2^28 primitives of one kind or more for one rank; take more ranks");
  }

  template <class Kind>
  void exchange(Kind kind, std::size_t first, std::size_t begin, std::size_t end) {
    std::vector<std::vector<std::uint32_t>> places(n_ranks());
    for (std::size_t i = begin; i < end; ++i)
      places[rank_of_[first + i]].push_back(static_cast<std::uint32_t>(i));
    std::vector<Bytes> messages(n_ranks());
    for (std::size_t to = 0; to < n_ranks(); ++to) pack(kind, places[to], messages[to]);
    messages = all_.exchange(std::move(messages));
    for (std::size_t from = 0; from < n_ranks(); ++from) unpack(kind, from, messages[from]);
  }

  template <class Kind>
  void pack(Kind, const std::vector<std::uint32_t>& places, Bytes& bytes) const {
    WireWriter writer(bytes);
    writer.put(static_cast<std::uint64_t>(places.size()));
    writer.put_some(Kind::of(set_), places);
    if constexpr (!Kind::kIsShape) {
      for (const std::uint32_t place : places)
        if (const auto& t = set_.triangles[place]; has_normals(t))
          writer.put(set_.normals[t.normals & KDRAY_NORMALS_MASK]);
      put_rows(writer, set_.colors, rows_.colors, places);
      put_rows(writer, set_.texcoords, rows_.texcoords, places);
    }
  }

  template <class List>
  static void put_rows(WireWriter& writer, const List& rows, std::size_t each,
                       const std::vector<std::uint32_t>& places) {
    for (const std::uint32_t place : places)
      for (std::size_t k = 0; k < each; ++k) writer.put(rows[place * each + k]);
  }

  template <class Kind>
  void unpack(Kind, std::size_t from, const Bytes& bytes) {
    WireReader reader(bytes, static_cast<int>(from));
    const auto n = reader.get<std::uint64_t>();
    std::uint64_t& next = next_[from].of[Kind::kNumber];
    if (n > end_[from].of[Kind::kNumber] - next) transport::throw_odd_message(static_cast<int>(from));
    reader.get_all(Kind::of(here_).data() + next, n);
    if constexpr (!Kind::kIsShape) {
      take_normals(reader, from, next, n);
      reader.get_all(here_.colors.data() + next * rows_.colors, n * rows_.colors);
      reader.get_all(here_.texcoords.data() + next * rows_.texcoords, n * rows_.texcoords);
    }
    reader.end();
    next += n;
  }

  void take_normals(WireReader& reader, std::size_t from, std::size_t first, std::size_t n) {
    std::uint64_t& next = next_[from].normals;
    for (std::size_t i = first; i < first + n; ++i) {
      layout::Triangle& t = here_.triangles[i];
      if (!has_normals(t)) continue;
      if (next == end_[from].normals) transport::throw_odd_message(static_cast<int>(from));
      here_.normals[next] = reader.get<layout::VertexNormals>();
      t.normals = (t.normals & KDRAY_ZERO_AREA) | static_cast<layout::u32>(next++);
    }
  }

  PrimitiveSet set_, here_;
  std::span<const std::uint32_t> rank_of_;
  CornerRows rows_;
  transport::Together& all_;
  std::vector<Counts> next_, end_;  // for each rank: where its next goes, and the end of its own
};

}  // namespace

PrimitiveSet bring(PrimitiveSet set, std::span<const std::uint32_t> rank_of, const CornerRows& rows,
                   transport::Together& all) {
  return Carrier(std::move(set), rank_of, rows, all).carry();
}

}  // namespace kdray::partition
