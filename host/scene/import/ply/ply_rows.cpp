#include "scene/import/ply/ply_rows.h"

#include <algorithm>
#include <string_view>
#include <system_error>
#include <vector>

#include "base/hash.h"
#include "scene/import/files.h"
#include "scene/import/ply/ply_source.h"

namespace kdray::scene::ply {

namespace {

constexpr std::size_t kMostHeader = std::size_t{1} << 20;
constexpr std::uint64_t kPiece = std::uint64_t{4} << 20;  // bytes of the file that are read at a time

// Returns the bytes of a row, with three entries in its list if it has one.
std::uint64_t stride_of(const Element& element) {
  std::uint64_t stride = 0;
  for (const Property& p : element.properties)
    stride += p.is_list ? size_of(p.count_type) + 3 * size_of(p.type) : size_of(p.type);
  return stride;
}

const Property* list_of_corners(const Element& element) {
  const Property* list = element.find("vertex_indices");
  if (!list) list = element.find("vertex_index");
  const auto n_lists = std::ranges::count_if(element.properties, &Property::is_list);
  return list && list->is_list && is_integer(list->type) && n_lists == 1 ? list : nullptr;
}

template <bool swap>
std::int64_t integer(const unsigned char* bytes, Type type) {
  return with_type(type, [&](auto t) { return static_cast<std::int64_t>(load<decltype(t), swap>(bytes)); });
}

// Returns false where one of n faces, `stride` bytes from one to the next, is no triangle of the file's
// vertices.
template <bool swap>
bool corners_of(const unsigned char* at, std::uint64_t stride, std::uint64_t n, const Property& list,
                std::uint64_t n_vertices, Corners* out) {
  const std::size_t size = size_of(list.type);
  for (std::uint64_t i = 0; i < n; ++i, at += stride) {
    if (integer<swap>(at, list.count_type) != 3) return false;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int64_t corner = integer<swap>(at + size_of(list.count_type) + k * size, list.type);
      if (corner < 0 || static_cast<std::uint64_t>(corner) >= n_vertices) return false;
      out[i][k] = static_cast<std::uint32_t>(corner);
    }
  }
  return true;
}

// Returns false where a value is not finite.
template <bool swap>
bool columns_of(const std::string& bytes, const Element& element, std::uint64_t n,
                const VertexColumns& columns, Vertices& out) {
  const Header from_here{.format = Format::little_endian, .elements = {}, .textures = {}};
  BinarySource<swap> source(bytes, from_here, "");
  Element rows = element;
  rows.count = n;
  return read_columns(source, rows, columns, out);
}

}  // namespace

std::optional<Rows> Rows::open(const std::filesystem::path& file) {
  std::error_code error;
  const bool packed = file.extension() != ".ply" && file.extension() != ".PLY";
  if (packed || !std::filesystem::is_regular_file(file, error)) return std::nullopt;
  const std::uintmax_t bytes = std::filesystem::file_size(file, error);
  Rows rows;
  rows.file_ = file.string();
  rows.in_.open(file, std::ios::binary);
  if (error || !rows.in_) return std::nullopt;
  std::string head(std::min<std::uintmax_t>(bytes, kMostHeader), '\0');
  if (!rows.in_.read(head.data(), static_cast<std::streamsize>(head.size()))) return std::nullopt;
  try {
    rows.header_ = read_header(head, rows.file_);
    if (!rows.place_elements(bytes)) return std::nullopt;
  } catch (const Error&) {
    return std::nullopt;  // reading the whole file says why
  }
  head.resize(rows.header_.body);
  rows.fingerprint_ = hash_of(head + std::to_string(bytes)).low;
  return rows;
}

bool Rows::place(const Element& element, std::uint64_t& at) {
  const bool is_face = element.name == "face", is_vertex = element.name == "vertex";
  if (element.name == "tristrips" || (element.has_lists() && !is_face)) return false;
  const Place place{&element, at, element.count, stride_of(element)};
  if (is_vertex) {
    vertices_ = place;
    columns_ = find_columns(header_, element, file_);
  } else if (is_face) {
    faces_ = place;
    corners_ = list_of_corners(element);
    if (!corners_ || find_face_columns(header_, element).any()) return false;
    for (const Property* p = element.properties.data(); p != corners_; ++p) corners_at_ += size_of(p->type);
  }
  at += place.n * place.stride;
  return true;
}

bool Rows::place_elements(std::uint64_t file_bytes) {
  if (header_.format == Format::ascii || !header_.textures.empty()) return false;
  std::uint64_t at = header_.body;
  for (const Element& element : header_.elements) {
    if (element.count == 0 || element.properties.empty()) continue;
    if (element.count > (file_bytes - at) / stride_of(element)) return false;  // it is cut short
    if (!place(element, at)) return false;
  }
  has_more_ = at < file_bytes;
  constexpr std::uint64_t kMost = 0xffffffffu;
  return vertices_.n < kMost && faces_.n < kMost;
}

template <class Use>
bool Rows::for_each_piece(const Place& place, const RowRange& range, const Use& use) {
  const std::uint64_t rows = std::max<std::uint64_t>(1, kPiece / std::max<std::uint64_t>(1, place.stride));
  std::string bytes;
  for (std::uint64_t done = 0; done < range.n; done += rows) {
    const std::uint64_t n = std::min(rows, range.n - done);
    bytes.resize(n * place.stride);
    in_.clear();
    in_.seekg(static_cast<std::streamoff>(place.begin + (range.first + done) * place.stride));
    if (!in_.read(bytes.data(), static_cast<std::streamsize>(bytes.size()))) return false;
    if (!use(done, n, bytes)) return false;
  }
  return true;
}

bool Rows::read_vertices(const RowRange& range, Vertices& out) {
  out.places.resize(range.n);
  if (columns_.has_normals) out.normals.resize(range.n);
  const float opaque = static_cast<float>(columns_.color_unit);
  if (columns_.has_colors) out.colors.assign(range.n, {0, 0, 0, opaque});
  return for_each_piece(
      vertices_, range, [&](std::uint64_t first, std::uint64_t n, const std::string& bytes) {
        Vertices piece{RawVector<dvec3>(n), RawVector<vec3>(columns_.has_normals ? n : 0), {}, {}};
        if (columns_.has_colors) piece.colors.assign(n, {0, 0, 0, opaque});
        const bool little = header_.format == Format::little_endian;
        const Element& element = *vertices_.element;
        const bool good = little == kLittleEndianHost ? columns_of<false>(bytes, element, n, columns_, piece)
                                                      : columns_of<true>(bytes, element, n, columns_, piece);
        const auto to = static_cast<std::ptrdiff_t>(first);
        std::ranges::copy(piece.places, out.places.begin() + to);
        std::ranges::copy(piece.normals, out.normals.begin() + to);
        std::ranges::copy(piece.colors, out.colors.begin() + to);
        return good;
      });
}

bool Rows::read_faces(const RowRange& range, RawVector<Corners>& out) {
  out.resize(range.n);
  return for_each_piece(faces_, range, [&](std::uint64_t first, std::uint64_t n, const std::string& bytes) {
    const auto* const at = reinterpret_cast<const unsigned char*>(bytes.data()) + corners_at_;
    const bool little = header_.format == Format::little_endian;
    return little == kLittleEndianHost
               ? corners_of<false>(at, faces_.stride, n, *corners_, n_vertices(), out.data() + first)
               : corners_of<true>(at, faces_.stride, n, *corners_, n_vertices(), out.data() + first);
  });
}

}  // namespace kdray::scene::ply
