#include "scene/import/gltf/gltf_accessor.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>

#include "scene/model/scene.h"

namespace kdray::scene::gltf {

namespace {

enum class Component { i8 = 5120, u8 = 5121, i16 = 5122, u16 = 5123, u32 = 5125, f32 = 5126 };

constexpr std::uint64_t kMostZeros = 1u << 16;

template <class T>
T load(const char* bytes) {
  // glTF is little-endian, as is every machine with an OpenCL device.
  T value;
  std::memcpy(&value, bytes, sizeof(T));
  return value;
}

template <class T>
double component_value(const char* bytes, bool normalized) {
  const auto value = static_cast<double>(load<T>(bytes));
  if (std::is_floating_point_v<T> || !normalized) return value;
  return std::max(value / static_cast<double>(std::numeric_limits<T>::max()), -1.0);
}

std::size_t size_of(Component c) {
  switch (c) {
    case Component::i8:
    case Component::u8:
      return 1;
    case Component::i16:
    case Component::u16:
      return 2;
    default:
      return 4;
  }
}

// Calls `use` with a value of the C++ type that `c` stands for.
template <class Use>
auto with_component(Component c, const Use& use) {
  switch (c) {
    case Component::i8:
      return use(std::int8_t{});
    case Component::u8:
      return use(std::uint8_t{});
    case Component::i16:
      return use(std::int16_t{});
    case Component::u16:
      return use(std::uint16_t{});
    case Component::u32:
      return use(std::uint32_t{});
    case Component::f32:
      break;
  }
  return use(float{});
}

Component component_of(const JsonNode& node) {
  const std::uint64_t code = whole(node);
  const bool known = code >= 5120 && code <= 5126 && code != 5124;
  if (!known) throw node.expected("a component type (5120 to 5123, 5125 or 5126)");
  return static_cast<Component>(code);
}

// Where an array's elements lie; all of them are inside `bytes`.
struct Elements {
  std::string_view bytes;
  std::size_t stride = 0;
  Component component = Component::f32;
  bool normalized = false;

  double at(std::uint64_t i, std::size_t c) const {
    const char* const at = bytes.data() + i * stride + c * size_of(component);
    return with_component(component, [&]<class T>(T) { return component_value<T>(at, normalized); });
  }
};

// Elements of `n` components each, at `offset` of a buffer view.
Elements find_elements(Document& document, const JsonNode& owner, const JsonNode& holder, std::uint64_t count,
                       std::size_t n, Component component) {
  const JsonNode& view = document.entry("bufferViews", holder["bufferView"]);
  const std::uint64_t offset = whole_or(holder, "byteOffset", 0);
  const std::size_t size = n * size_of(component);
  const std::uint64_t stride = whole_or(view, "byteStride", size);
  if (stride < size || stride > 4096)
    throw view["byteStride"].error("does not fit elements of " + std::to_string(size) + " bytes");
  std::string_view bytes = document.view_bytes(view);
  const bool fits =
      offset <= bytes.size() &&
      (count == 0 || (size <= bytes.size() - offset && (bytes.size() - offset - size) / stride >= count - 1));
  if (!fits) {
    throw owner.error("its " + std::to_string(count) + " elements reach beyond the " +
                      std::to_string(bytes.size()) + " bytes of their buffer view");
  }
  bytes.remove_prefix(offset);
  return {bytes, stride, component};
}

std::uint64_t sparse_index(const Elements& indices, std::uint64_t i) {
  return static_cast<std::uint64_t>(indices.at(i, 0));
}

// The elements that an accessor is read into, of kParts components each.
struct Vectors {
  using Element = dvec3;
  static constexpr std::size_t kParts = 3;
  static void set(dvec3& element, std::size_t c, double value) { element[static_cast<int>(c)] = value; }
};
template <std::size_t n_parts, std::size_t n_kept>
struct Floats {
  using Element = std::array<float, n_kept>;
  static constexpr std::size_t kParts = n_parts;
  static void set(Element& element, std::size_t c, double value) { element[c] = static_cast<float>(value); }
};
template <std::size_t n_parts>
struct Doubles {
  using Element = std::array<double, n_parts>;
  static constexpr std::size_t kParts = n_parts;
  static void set(Element& element, std::size_t c, double value) { element[c] = value; }
};
struct Matrices {
  using Element = dmat4;
  static constexpr std::size_t kParts = 16;
  static void set(dmat4& element, std::size_t c, double value) {
    element[static_cast<int>(c / 4)][static_cast<int>(c % 4)] = value;
  }
};
struct Indices {
  using Element = std::uint32_t;
  static constexpr std::size_t kParts = 1;
  static void set(std::uint32_t& element, std::size_t, double value) {
    element = static_cast<std::uint32_t>(value);
  }
};

// Copies all of `from`, by one loop for each type of component.
template <class Kind>
void copy_elements(const Elements& from, RawVector<typename Kind::Element>& out) {
  with_component(from.component, [&]<class T>(T) {
    for (std::size_t i = 0; i < out.size(); ++i) {
      for (std::size_t c = 0; c < Kind::kParts; ++c) {
        const char* bytes = from.bytes.data() + i * from.stride + c * sizeof(T);
        Kind::set(out[i], c, component_value<T>(bytes, from.normalized));
      }
    }
  });
}

// Replaces elements of `out` as the accessor's "sparse" says.
template <class Kind>
void apply_sparse(Document& document, const JsonNode& accessor, Component component, bool normalized,
                  RawVector<typename Kind::Element>& out) {
  const auto sparse = accessor.find("sparse");
  if (!sparse) return;
  const std::uint64_t count = whole((*sparse)["count"]);
  const JsonNode indices_node = (*sparse)["indices"];
  const JsonNode values_node = (*sparse)["values"];
  const Component index_type = component_of(indices_node["componentType"]);
  if (index_type != Component::u8 && index_type != Component::u16 && index_type != Component::u32) {
    throw indices_node["componentType"].expected("an unsigned integer type (5121, 5123 or 5125)");
  }
  const Elements indices = find_elements(document, indices_node, indices_node, count, 1, index_type);
  Elements values = find_elements(document, values_node, values_node, count, Kind::kParts, component);
  values.normalized = normalized;
  for (std::uint64_t i = 0; i < count; ++i) {
    const std::uint64_t at = sparse_index(indices, i);
    if (at >= out.size())
      throw indices_node.error("names element " + std::to_string(at) + ", which is not there");
    for (std::size_t c = 0; c < Kind::kParts; ++c) Kind::set(out[at], c, values.at(i, c));
  }
}

// Returns the elements that were unpacked for an accessor.
template <class Kind>
RawVector<typename Kind::Element> copy_unpacked(const Unpacked& from, bool normalized) {
  const auto component = static_cast<Component>(from.component);
  RawVector<typename Kind::Element> out;
  out.resize(from.count);
  if (from.bytes.size() / (Kind::kParts * size_of(component)) < from.count)
    throw Error(ErrorCode::internal, "a packed accessor has fewer components than its type");
  copy_elements<Kind>({from.bytes, Kind::kParts * size_of(component), component, normalized}, out);
  return out;
}

template <class Kind>
RawVector<typename Kind::Element> read_elements(Document& document, const JsonNode& accessor,
                                                Component component) {
  const std::uint64_t count = accessor_count(accessor);
  const auto flag = accessor.find("normalized");
  const bool normalized = flag && component != Component::f32 && flag->boolean();
  if (const Unpacked* const unpacked = document.unpacked(accessor))
    return copy_unpacked<Kind>(*unpacked, normalized);
  RawVector<typename Kind::Element> out;
  if (accessor.find("bufferView")) {
    Elements elements = find_elements(document, accessor, accessor, count, Kind::kParts, component);
    elements.normalized = normalized;
    out.resize(count);
    copy_elements<Kind>(elements, out);
  } else if (count > std::max(kMostZeros, document.bytes_read())) {
    throw accessor["count"].error("as many zeros as that are not believed", "give the accessor a bufferView");
  } else {
    out.assign(count, typename Kind::Element{});
  }
  apply_sparse<Kind>(document, accessor, component, normalized, out);
  return out;
}

void expect_type(const JsonNode& accessor, const std::string& wanted) {
  const JsonNode type = accessor["type"];
  if (type.string() != wanted) throw type.expected("\"" + wanted + "\"");
}

}  // namespace

std::uint64_t accessor_count(const JsonNode& accessor) {
  const JsonNode node = accessor["count"];
  const std::uint64_t count = whole(node);
  if (count >= kNone) throw node.expected("fewer than 2^32 elements");
  return count;
}

RawVector<dvec3> read_vectors(Document& document, const JsonNode& accessor, NotFinite other) {
  expect_type(accessor, "VEC3");
  auto out = read_elements<Vectors>(document, accessor, component_of(accessor["componentType"]));
  for (std::size_t i = 0; i < out.size() && other == NotFinite::refused; ++i) {
    if (!is_finite(out[i])) throw accessor.error("element " + std::to_string(i) + " is not finite");
  }
  return out;
}

namespace {

template <class Elements>
void check_finite(const JsonNode& accessor, const Elements& elements, NotFinite other) {
  if (other == NotFinite::nan) return;
  for (std::size_t i = 0; i < elements.size(); ++i)
    for (const auto part : elements[i])
      if (!std::isfinite(part)) throw accessor.error("element " + std::to_string(i) + " is not finite");
}

template <std::size_t n_parts>
auto read_doubles(Document& document, const JsonNode& accessor, NotFinite other = NotFinite::refused) {
  auto out = read_elements<Doubles<n_parts>>(document, accessor, component_of(accessor["componentType"]));
  check_finite(accessor, out, other);
  return out;
}

}  // namespace

RawVector<double> read_scalars(Document& document, const JsonNode& accessor) {
  expect_type(accessor, "SCALAR");
  const auto all = read_doubles<1>(document, accessor);
  RawVector<double> out(all.size());
  for (std::size_t i = 0; i < all.size(); ++i) out[i] = all[i][0];
  return out;
}

RawVector<std::array<double, 4>> read_quads(Document& document, const JsonNode& accessor, NotFinite other) {
  expect_type(accessor, "VEC4");
  return read_doubles<4>(document, accessor, other);
}

// Only floats are read: columns of smaller components would be padded.
RawVector<dmat4> read_matrices(Document& document, const JsonNode& accessor) {
  expect_type(accessor, "MAT4");
  const Component component = component_of(accessor["componentType"]);
  if (component != Component::f32) throw accessor["componentType"].expected("floats (5126)");
  auto out = read_elements<Matrices>(document, accessor, component);
  for (std::size_t i = 0; i < out.size(); ++i)
    for (int c = 0; c < 16; ++c)
      if (!std::isfinite(out[i][c / 4][c % 4]))
        throw accessor.error("element " + std::to_string(i) + " is not finite");
  return out;
}

RawVector<std::array<float, 2>> read_pairs(Document& document, const JsonNode& accessor, NotFinite other) {
  expect_type(accessor, "VEC2");
  auto out = read_elements<Floats<2, 2>>(document, accessor, component_of(accessor["componentType"]));
  check_finite(accessor, out, other);
  return out;
}

RawVector<std::array<float, 4>> read_colors(Document& document, const JsonNode& accessor, NotFinite other) {
  const Component component = component_of(accessor["componentType"]);
  RawVector<std::array<float, 4>> out;
  if (accessor["type"].string() == "VEC4") {
    out = read_elements<Floats<4, 4>>(document, accessor, component);
  } else {
    expect_type(accessor, "VEC3");
    out = read_elements<Floats<3, 4>>(document, accessor, component);
    for (auto& color : out) color[3] = 1;
  }
  check_finite(accessor, out, other);
  return out;
}

RawVector<std::uint32_t> read_indices(Document& document, const JsonNode& accessor, std::uint64_t end) {
  expect_type(accessor, "SCALAR");
  const Component component = component_of(accessor["componentType"]);
  if (component != Component::u8 && component != Component::u16 && component != Component::u32) {
    throw accessor["componentType"].expected("an unsigned integer type (5121, 5123 or 5125)");
  }
  auto out = read_elements<Indices>(document, accessor, component);
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (out[i] < end) continue;
    throw accessor.error("index " + std::to_string(i) + " names vertex " + std::to_string(out[i]) + " of " +
                         std::to_string(end));
  }
  return out;
}

}  // namespace kdray::scene::gltf
