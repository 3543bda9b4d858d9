// What    Small glTF files for tests: a JSON text around buffers in data: URIs, and the same as GLB.
#pragma once

#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace kdray::test {

template <class T>
std::string bytes_of(const std::vector<T>& values) {
  std::string out(values.size() * sizeof(T), '\0');
  if (!out.empty()) std::memcpy(out.data(), values.data(), out.size());
  return out;
}

inline std::string base64(const std::string& bytes) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      bits = bits << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      out += i + k > bytes.size() ? '=' : kDigits[bits >> (18 - 6 * k) & 63];
    }
  }
  return out;
}

// A file that grows buffer by buffer. Everything of it is in `json`.
class GltfSample {
 public:
  nlohmann::json json = {{"asset", {{"version", "2.0"}}},
                         {"scene", 0},
                         {"scenes", {{{"nodes", {0}}}}},
                         {"nodes", {{{"mesh", 0}}}}};

  // A buffer and a view of all of it; gives the view's number.
  int view(const std::string& bytes, int stride = 0) {
    json["buffers"].push_back(
        {{"byteLength", bytes.size()}, {"uri", "data:application/octet-stream;base64," + base64(bytes)}});
    nlohmann::json view = {{"buffer", json["buffers"].size() - 1}, {"byteLength", bytes.size()}};
    if (stride > 0) view["byteStride"] = stride;
    json["bufferViews"].push_back(view);
    return static_cast<int>(json["bufferViews"].size()) - 1;
  }
  int accessor(int view, int component, const std::string& type, std::size_t count) {
    json["accessors"].push_back(
        {{"bufferView", view}, {"componentType", component}, {"type", type}, {"count", count}});
    return static_cast<int>(json["accessors"].size()) - 1;
  }
  int vectors(const std::vector<float>& values) {
    return accessor(view(bytes_of(values)), 5126, "VEC3", values.size() / 3);
  }
  template <class T>
  int indices(const std::vector<T>& values) {
    constexpr int kComponent = sizeof(T) == 1 ? 5121 : sizeof(T) == 2 ? 5123 : 5125;
    return accessor(view(bytes_of(values)), kComponent, "SCALAR", values.size());
  }
  nlohmann::json& primitive() { return json["meshes"][0]["primitives"][0]; }

  std::string text() const { return json.dump(); }

  // The same with the first buffer in the binary chunk.
  std::string glb(const std::string& first_buffer) const {
    nlohmann::json copy = json;
    copy["buffers"][0].erase("uri");
    std::string text = copy.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    std::string binary = first_buffer;
    binary.resize((binary.size() + 3) / 4 * 4, '\0');
    const auto word = [](std::size_t v) { return bytes_of<std::uint32_t>({static_cast<std::uint32_t>(v)}); };
    return "glTF" + word(2) + word(28 + text.size() + binary.size()) + word(text.size()) + "JSON" + text +
           word(binary.size()) + std::string("BIN\0", 4) + binary;
  }
};

// A square of two triangles in the plane z = 0: corners (0,0) (1,0) (1,1) (0,1), 16-bit indices.
inline GltfSample square() {
  GltfSample sample;
  sample.primitive()["attributes"]["POSITION"] = sample.vectors({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0});
  sample.primitive()["indices"] = sample.indices<std::uint16_t>({0, 1, 2, 0, 2, 3});
  return sample;
}

}  // namespace kdray::test
