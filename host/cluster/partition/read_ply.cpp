// What    Reads a binary PLY file in shares: each rank a run of its vertices and one of its faces.
// Shape   A rank goes through its faces some at a time, twice: to tell the vertices' holders which of them
//         are used, from which the scene's space follows; and to fetch them, make triangles, and let go of
//         them. What is made of some faces is made by the code that makes it of all.
// Memory  The share's vertices, faces and triangles, and a batch of each.
#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "base/box.h"
#include "cluster/partition/primitive_set.h"
#include "cluster/partition/share.h"
#include "cluster/transport/together.h"
#include "scene/import/files.h"
#include "scene/import/load.h"
#include "scene/import/ply/ply_rows.h"
#include "scene/model/frame.h"
#include "scene/model/normals.h"

namespace kdray::partition {

namespace {

using scene::ply::Corners, scene::ply::Rows, scene::ply::Vertices;
using transport::Bytes, transport::WireReader, transport::WireWriter;

// The vertices of a mesh, of which each rank holds a run. A rank that needs vertices names them in ascending
// order, each once, and gets them in that order. All ranks ask at the same time, those that need nothing as
// well. What is asked for at a time takes memory twice.
class VertexHolders {
 public:
  // `own` are those of slice_of(rows.n_vertices(), rank, size).
  VertexHolders(transport::Together& all, const Rows& rows, Vertices own);

  // Tells the holders of these vertices that they are used.
  void use(const std::vector<std::uint32_t>& wanted);
  // Returns the bounds of all vertices that are used.
  DBox bounds_of_used();

  Vertices fetch(const std::vector<std::uint32_t>& wanted);

 private:
  std::vector<std::vector<std::uint32_t>> ask(const std::vector<std::uint32_t>& wanted);

  transport::Together& all_;
  std::uint64_t n_vertices_;
  scene::ply::VertexColumns columns_;
  std::uint64_t first_;
  Vertices own_;
  std::vector<std::uint8_t> used_;
};

VertexHolders::VertexHolders(transport::Together& all, const scene::ply::Rows& rows, Vertices own)
    : all_(all),
      n_vertices_(rows.n_vertices()),
      columns_(rows.columns()),
      first_(slice_of(n_vertices_, all.rank(), all.size()).first),
      own_(std::move(own)),
      used_(own_.places.size()) {}

// Returns what each rank wants of this one, as places among its own.
std::vector<std::vector<std::uint32_t>> VertexHolders::ask(const std::vector<std::uint32_t>& wanted) {
  std::vector<Bytes> out(static_cast<std::size_t>(all_.size()));
  auto first = wanted.begin();
  for (int to = 0; to < all_.size(); ++to) {
    const auto last = std::lower_bound(first, wanted.end(), slice_of(n_vertices_, to, all_.size()).last);
    out[static_cast<std::size_t>(to)] = transport::bytes_of_list(std::span(first, last));
    first = last;
  }
  const std::vector<Bytes> in = all_.exchange(std::move(out));
  std::vector<std::vector<std::uint32_t>> asked(in.size());
  for (std::size_t from = 0; from < in.size(); ++from) {
    WireReader reader(in[from], static_cast<int>(from));
    reader.take(asked[from], in[from].size() / sizeof(std::uint32_t));
    reader.end();
    for (std::uint32_t& vertex : asked[from]) {
      vertex = static_cast<std::uint32_t>(vertex - first_);  // what is before the first becomes large
      if (vertex >= own_.places.size()) transport::throw_odd_message(static_cast<int>(from));
    }
  }
  return asked;
}

void VertexHolders::use(const std::vector<std::uint32_t>& wanted) {
  for (const auto& asked : ask(wanted))
    for (const std::uint32_t vertex : asked) used_[vertex] = 1;
}

DBox VertexHolders::bounds_of_used() {
  DBox box;
  for (std::size_t i = 0; i < used_.size(); ++i)
    if (used_[i] != 0) box.grow(own_.places[i]);
  return all_.join_values(box, [](DBox& sum, const DBox& one) { sum.grow(one); });
}

Vertices VertexHolders::fetch(const std::vector<std::uint32_t>& wanted) {
  const auto asked = ask(wanted);
  std::vector<Bytes> out(asked.size());
  for (std::size_t to = 0; to < asked.size(); ++to) {
    WireWriter writer(out[to]);
    writer.put_some(own_.places, asked[to]);
    if (!own_.normals.empty()) writer.put_some(own_.normals, asked[to]);
    if (!own_.colors.empty()) writer.put_some(own_.colors, asked[to]);
  }
  const std::vector<Bytes> in = all_.exchange(std::move(out));
  Vertices found;
  auto first = wanted.begin();
  for (int from = 0; from < all_.size(); ++from) {
    const auto last = std::lower_bound(first, wanted.end(), slice_of(n_vertices_, from, all_.size()).last);
    const auto n = static_cast<std::size_t>(last - first);
    WireReader reader(in[static_cast<std::size_t>(from)], from);
    reader.take(found.places, n);
    if (columns_.has_normals) reader.take(found.normals, n);
    if (columns_.has_colors) reader.take(found.colors, n);
    reader.end();
    first = last;
  }
  return found;
}

constexpr std::size_t kBatchOfFaces = std::size_t{1} << 17;  // faces

scene::ply::RowRange range_of(const Slice& slice) {
  return {slice.first, slice.last - slice.first};
}

// Returns the vertices of some faces, in ascending order.
std::vector<std::uint32_t> vertices_of(std::span<const Corners> faces) {
  std::vector<std::uint32_t> vertices;
  vertices.reserve(3 * faces.size());
  for (const Corners& corners : faces) vertices.insert(vertices.end(), corners.begin(), corners.end());
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  return vertices;
}

std::uint32_t place_in(const std::vector<std::uint32_t>& vertices, std::uint32_t vertex) {
  return static_cast<std::uint32_t>(std::lower_bound(vertices.begin(), vertices.end(), vertex) -
                                    vertices.begin());
}

class PlyReader {
 public:
  PlyReader(const std::filesystem::path& file, Rows& rows, transport::Together& all)
      : file_(file.string()), rows_(rows), all_(all) {}

  // Returns false where a row is unusable, on any rank.
  bool read_rows() {
    const Slice vertices = slice_of(rows_.n_vertices(), all_.rank(), all_.size());
    const Slice faces = slice_of(rows_.n_faces(), all_.rank(), all_.size());
    first_face_ = faces.first;
    Vertices own;
    const bool good =
        rows_.read_vertices(range_of(vertices), own) && rows_.read_faces(range_of(faces), faces_);
    if (all_.any(!good)) return false;
    holders_.emplace(all_, rows_, std::move(own));
    n_rounds_ = all_.most((faces_.size() + kBatchOfFaces - 1) / kBatchOfFaces);
    return true;
  }

  Share read(const LoadOptions& options, std::vector<scene::FileRead> files) {
    for (std::size_t round = 0; round < n_rounds_; ++round) holders_->use(vertices_of(faces_of(round)));
    const DBox bounds = holders_->bounds_of_used();
    prepare::Prepared& whole = share_.whole;
    whole.geometry.space = scene::space_of(bounds, file_);
    describe_settings(options, std::move(files));
    for (std::size_t round = 0; round < n_rounds_; ++round) make_triangles(faces_of(round));
    facts_ = all_.join_values(facts_, [](Facts& sum, const Facts& one) { sum.add(one); });
    holders_.reset();
    faces_ = {};
    warn();
    frame(bounds);
    tell(facts_, whole);
    whole.flat.lights = flatten::pack_lights(whole.settings, whole.geometry.space);
    if (facts_.zero_area > 0) settle_zero_area(share_.primitives, all_);
    return std::move(share_);
  }

 private:
  std::span<const Corners> faces_of(std::size_t round) const {
    const std::size_t first = std::min(faces_.size(), round * kBatchOfFaces);
    return std::span(faces_).subspan(first, std::min(kBatchOfFaces, faces_.size() - first));
  }

  // Material and maps are those of a file without faces: they follow from the vertices' properties.
  void describe_settings(const LoadOptions& options, std::vector<scene::FileRead> files) {
    const std::uint32_t n = rows_.n_vertices() > 0 ? 1 : 0;
    scene::ply::Mesh mesh(n);
    mesh.vertices().places.assign(n, dvec3(0));
    if (rows_.columns().has_colors) mesh.vertices().colors.resize(n);
    scene::Scene empty = mesh.finish(file_);
    empty.name = file_;
    empty.load_options = options;
    empty.files = std::move(files);
    empty.warnings.clear();
    prepare::Prepared& whole = share_.whole;
    whole.settings = prepare::settings_of(empty);
    whole.flat.materials = flatten::pack_materials(empty);
    if (!empty.texturing.material_maps.empty()) whole.flat.material_maps = flatten::pack_material_maps(empty);
  }

  void make_triangles(std::span<const Corners> faces) {
    const std::vector<std::uint32_t> wanted = vertices_of(faces);
    Vertices vertices = holders_->fetch(wanted);
    if (faces.empty()) return;
    scene::ply::Mesh mesh(static_cast<std::uint32_t>(wanted.size()));
    mesh.vertices() = std::move(vertices);
    mesh.set_color_unit(rows_.columns().color_unit);
    for (const Corners& c : faces)
      mesh.add_triangle(place_in(wanted, c[0]), place_in(wanted, c[1]), place_in(wanted, c[2]));
    scene::Scene part = mesh.finish(file_);
    const auto first =
        static_cast<std::uint32_t>(first_face_ + static_cast<std::size_t>(faces.data() - faces_.data()));
    for (scene::Triangle& t : part.triangles) t.number += first;
    sample_middles(part);
    const scene::Geometry geometry = scene::make_geometry_in(share_.whole.geometry.space, part);
    add_slice(share_.primitives, part, geometry, flatten::flatten(part, geometry, kdtree::Tree(), false), 0,
              1);
    facts_.add(part, geometry);
    facts_.shaded_flat += mesh.n_shaded_flat();
  }

  void sample_middles(const scene::Scene& part) {
    const std::size_t step = scene::step_of_samples(rows_.n_faces());
    for (const scene::Triangle& t : part.triangles) {
      if (t.number % step != 0) continue;
      const auto& at = part.vertices;
      middles_.push_back((at[t.vertex[0]] + at[t.vertex[1]] + at[t.vertex[2]]) / 3.0);
    }
  }

  // They come in the order of ply.cpp.
  void warn() {
    std::vector<std::string>& warnings = share_.whole.settings.warnings;
    for (const std::string& what : rows_.left_out()) warnings.push_back(file_ + ": " + what);
    if (rows_.has_more())
      warnings.push_back(file_ + ": more data after the last element of the header are left out");
    if (rows_.n_faces() == 0) warnings.push_back(scene::nothing_to_see(file_));
    if (facts_.shaded_flat > 0) warnings.push_back(scene::flat_warning(file_, facts_.shaded_flat));
  }

  void frame(const DBox& bounds) {
    std::vector<dvec3> middles;
    const auto parts = all_.gather(transport::bytes_of_list(std::span<const dvec3>(middles_)));
    for (std::size_t from = 0; from < parts.size(); ++from) {
      WireReader reader(parts[from], static_cast<int>(from));
      reader.take(middles, parts[from].size() / sizeof(dvec3));
      reader.end();
    }
    scene::frame_scene(
        share_.whole.settings,
        {.bounds = bounds, .n_primitives = rows_.n_faces(), .middles = [&] { return middles; }});
  }

  std::string file_;
  Rows& rows_;
  transport::Together& all_;
  std::size_t first_face_ = 0, n_rounds_ = 0;
  RawVector<Corners> faces_;
  std::optional<VertexHolders> holders_;
  std::vector<dvec3> middles_;
  Facts facts_;
  Share share_;
};

// Opens the file. Returns nothing where some rank can't, or has another file.
std::optional<Rows> open_together(const std::filesystem::path& file, transport::Together& all) {
  std::optional<Rows> rows = Rows::open(file);
  const std::uint64_t own = rows ? rows->fingerprint() | 1 : 0;
  const std::uint64_t most = all.most(own), inverse = all.most(~own);
  if (most == 0 || inverse != ~most) return std::nullopt;
  return rows;
}

}  // namespace

std::optional<Share> read_in_shares(const std::filesystem::path& file, const LoadOptions& options,
                                    transport::Together& all) {
  if (options.smooth_degrees || options.time) return std::nullopt;  // the latter has to be warned of
  scene::FilesRead files;
  std::optional<Rows> rows = open_together(file, all);
  if (!rows) return std::nullopt;
  PlyReader reader(file, *rows, all);
  if (!reader.read_rows()) return std::nullopt;
  std::vector<scene::FileRead> read = files.take();
  read.insert(read.begin(), scene::FileRead{file, {}, false});
  return reader.read(options, std::move(read));
}

}  // namespace kdray::partition
