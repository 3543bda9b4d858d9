#include "scene/gltf_accessor.h"

#include <algorithm>
#include <cstring>
#include <limits>

#include "scene/scene.h"

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
  if (!normalized) return value;
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

double load_component(const char* bytes, Component c, bool normalized) {
  switch (c) {
    case Component::i8:
      return component_value<std::int8_t>(bytes, normalized);
    case Component::u8:
      return component_value<std::uint8_t>(bytes, normalized);
    case Component::i16:
      return component_value<std::int16_t>(bytes, normalized);
    case Component::u16:
      return component_value<std::uint16_t>(bytes, normalized);
    case Component::u32:
      return component_value<std::uint32_t>(bytes, normalized);
    case Component::f32:
      break;
  }
  return static_cast<double>(load<float>(bytes));
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
    return load_component(bytes.data() + i * stride + c * size_of(component), component, normalized);
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

// Replaces elements of `out`, of n components each, as the accessor's "sparse" says.
void apply_sparse(Document& document, const JsonNode& accessor, std::size_t n, Component component,
                  bool normalized, std::vector<double>& out) {
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
  Elements values = find_elements(document, values_node, values_node, count, n, component);
  values.normalized = normalized;
  for (std::uint64_t i = 0; i < count; ++i) {
    const std::uint64_t at = sparse_index(indices, i);
    if (at >= out.size() / n)
      throw indices_node.error("names element " + std::to_string(at) + ", which is not there");
    for (std::size_t c = 0; c < n; ++c) out[at * n + c] = values.at(i, c);
  }
}

// All components of all elements.
std::vector<double> read_components(Document& document, const JsonNode& accessor, std::size_t n,
                                    Component component) {
  const std::uint64_t count = accessor_count(accessor);
  const auto flag = accessor.find("normalized");
  const bool normalized = flag && component != Component::f32 && flag->boolean();
  std::vector<double> out;
  if (accessor.find("bufferView")) {
    Elements elements = find_elements(document, accessor, accessor, count, n, component);
    elements.normalized = normalized;
    out.resize(count * n);
    for (std::uint64_t i = 0; i < count; ++i) {
      for (std::size_t c = 0; c < n; ++c) out[i * n + c] = elements.at(i, c);
    }
  } else if (count > std::max<std::uint64_t>(kMostZeros, document.file_size())) {
    throw accessor["count"].error("as many zeros as that are not believed", "give the accessor a bufferView");
  } else {
    out.resize(count * n);
  }
  apply_sparse(document, accessor, n, component, normalized, out);
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

std::vector<dvec3> read_vectors(Document& document, const JsonNode& accessor) {
  expect_type(accessor, "VEC3");
  const std::vector<double> values =
      read_components(document, accessor, 3, component_of(accessor["componentType"]));
  std::vector<dvec3> out(values.size() / 3);
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i] = {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
    if (!is_finite(out[i])) throw accessor.error("element " + std::to_string(i) + " is not finite");
  }
  return out;
}

std::vector<std::uint32_t> read_indices(Document& document, const JsonNode& accessor, std::uint64_t end) {
  expect_type(accessor, "SCALAR");
  const Component component = component_of(accessor["componentType"]);
  if (component != Component::u8 && component != Component::u16 && component != Component::u32) {
    throw accessor["componentType"].expected("an unsigned integer type (5121, 5123 or 5125)");
  }
  const std::vector<double> values = read_components(document, accessor, 1, component);
  std::vector<std::uint32_t> out(values.size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (!(values[i] < static_cast<double>(end))) {
      throw accessor.error("index " + std::to_string(i) + " names vertex " +
                           std::to_string(static_cast<std::uint64_t>(values[i])) + " of " +
                           std::to_string(end));
    }
    out[i] = static_cast<std::uint32_t>(values[i]);
  }
  return out;
}

}  // namespace kdray::scene::gltf
