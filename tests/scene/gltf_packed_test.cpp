// What    glTF meshes packed by Draco and meshopt, against the same meshes unpacked; streams that are
//         damaged, that promise too much, or that this kdray wasn't built for.
#include <gtest/gtest.h>

#include <random>

#include "base/error.h"
#include "scene/import/gltf/gltf_document.h"
#include "scene/import/load.h"
#include "scene/model/check_scene.h"
#include "scene/packed_samples.h"
#include "scene/scratch.h"
#include "support/data.h"
#ifdef KDRAY_WITH_DRACO
#include <draco/compression/expert_encode.h>
#include <draco/mesh/mesh.h>
#endif
#ifdef KDRAY_WITH_MESHOPT
#include <meshoptimizer.h>
#endif

namespace kdray::scene {
namespace {

using nlohmann::json;
using test::bytes_of;
using test::GltfSample;
using test::Sheet;

#define EXPECT_SAYS(message, part) EXPECT_NE((message).find(part), std::string::npos) << (message)

Scene read(const GltfSample& sample) {
  Scene scene = read_gltf(sample.text(), "a.gltf");
  check_scene(scene);
  return scene;
}
std::string refused(const GltfSample& sample) {
  return test::refusal([&] { read_gltf(sample.text(), "a.gltf"); });
}

// Everything of the sheet is where it belongs, up to `error` in positions and normals.
void expect_sheet(const Scene& s, double error) {
  const Sheet sheet;
  EXPECT_TRUE(s.warnings.empty()) << s.warnings.front();
  const auto place = [&](std::size_t i) {
    return test::place_of(s.vertices[s.triangles[i / 3].vertex[i % 3]]);
  };
  const auto wanted = [&](std::size_t i) { return static_cast<int>(sheet.corners[i]); };
  ASSERT_EQ(3 * s.triangles.size(), sheet.corners.size());
  EXPECT_EQ(test::triangles_of(place, sheet.corners.size()),
            test::triangles_of(wanted, sheet.corners.size()));
  ASSERT_EQ(s.texturing.texcoords[0].size(), s.triangles.size());
  ASSERT_EQ(s.texturing.colors.size(), s.triangles.size());
  for (std::size_t i = 0; i < sheet.corners.size(); ++i) {
    const auto& t = s.triangles[i / 3];
    const auto at = static_cast<std::size_t>(place(i));
    ASSERT_NE(t.normal[i % 3], kNone);
    for (std::size_t c = 0; c < 3; ++c) {
      const auto part = static_cast<int>(c);
      EXPECT_NEAR(s.vertices[t.vertex[i % 3]][part], sheet.positions[3 * at + c], error);
      EXPECT_NEAR(s.normals[t.normal[i % 3]][part], sheet.normals[3 * at + c], 8 * error + 1e-6);
    }
    EXPECT_NEAR(s.texturing.texcoords[0][i / 3].uv[i % 3][0], sheet.coordinates[2 * at], error);
    EXPECT_NEAR(s.texturing.texcoords[0][i / 3].uv[i % 3][1], sheet.coordinates[2 * at + 1], error);
    const auto& rg = s.texturing.colors[i / 3].c[i % 3][0];
    EXPECT_EQ(rg & 0xffff, linear_unit(sheet.colors[4 * at] / 255.0));
    EXPECT_EQ(rg >> 16, linear_unit(sheet.colors[4 * at + 1] / 255.0));
  }
}

TEST(PackedGltf, ThePlainSheetIsAsTheTestsHaveIt) {
  expect_sheet(read(plain(Sheet())), 0);
}

// Loads as a scene that keeps all promises, or is refused in one line.
void expect_safe(const GltfSample& sample) {
  try {
    check_scene(read_gltf(sample.text(), "a.gltf"));
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::input) << e.what();
    EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos) << e.what();
  }
}

// Every prefix of the stream, and streams with some bytes changed. `make` puts a stream into a file.
void mutate_stream(const std::string& good, const std::function<GltfSample(const std::string&)>& make,
                   int rounds) {
  for (std::size_t n = 0; n < good.size(); n += 1 + good.size() / 400) expect_safe(make(good.substr(0, n)));
  std::mt19937 random(28);
  SCOPED_TRACE("seed 28");
  for (int round = 0; round < rounds; ++round) {
    std::string bad = good;
    // Counts and methods are in the first bytes.
    const std::size_t within = round % 2 == 0 ? bad.size() : std::min<std::size_t>(bad.size(), 60);
    for (unsigned i = 0; i <= random() % 4; ++i) bad[random() % within] = static_cast<char>(random());
    expect_safe(make(bad));
  }
}

#ifdef KDRAY_WITH_DRACO

std::string bytes_in(const draco::EncoderBuffer& buffer) {
  return {buffer.data(), buffer.size()};
}

void add_attribute(draco::Mesh& mesh, draco::GeometryAttribute::Type type, int parts,
                   draco::DataType component, const void* values, std::size_t n) {
  draco::GeometryAttribute a;
  const int size = parts * draco::DataTypeLength(component);
  a.Init(type, nullptr, static_cast<std::uint8_t>(parts), component, component == draco::DT_UINT8, size, 0);
  const int id = mesh.AddAttribute(a, true, static_cast<std::uint32_t>(n));
  for (std::uint32_t i = 0; i < n; ++i)
    mesh.attribute(id)->SetAttributeValue(
        draco::AttributeValueIndex(i),
        static_cast<const char*>(values) + i * static_cast<std::uint32_t>(size));
}

// In the order of kNames. `bits` 0: nothing is rounded.
std::string draco_of(const Sheet& sheet, int method, int bits) {
  draco::Mesh mesh;
  mesh.set_num_points(static_cast<std::uint32_t>(sheet.size()));
  for (std::size_t i = 0; i < sheet.corners.size(); i += 3)
    mesh.AddFace({draco::PointIndex(sheet.corners[i]), draco::PointIndex(sheet.corners[i + 1]),
                  draco::PointIndex(sheet.corners[i + 2])});
  add_attribute(mesh, draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32, sheet.positions.data(),
                sheet.size());
  add_attribute(mesh, draco::GeometryAttribute::NORMAL, 3, draco::DT_FLOAT32, sheet.normals.data(),
                sheet.size());
  add_attribute(mesh, draco::GeometryAttribute::TEX_COORD, 2, draco::DT_FLOAT32, sheet.coordinates.data(),
                sheet.size());
  add_attribute(mesh, draco::GeometryAttribute::COLOR, 4, draco::DT_UINT8, sheet.colors.data(), sheet.size());
  draco::ExpertEncoder encoder(mesh);
  encoder.SetEncodingMethod(method);
  encoder.SetSpeedOptions(0, 0);
  if (bits > 0)
    for (int i = 0; i < 3; ++i) encoder.SetAttributeQuantization(i, bits);
  draco::EncoderBuffer buffer;
  EXPECT_TRUE(encoder.EncodeToBuffer(&buffer).ok());
  return bytes_in(buffer);
}

constexpr const char* kNames[] = {"POSITION", "NORMAL", "TEXCOORD_0", "COLOR_0"};

GltfSample packed_by_draco(const std::string& stream) {
  const Sheet sheet;
  GltfSample sample;
  const int view = sample.view(stream);
  json attributes;
  for (int i = 0; i < 4; ++i) {
    const char* const type = i == 2 ? "VEC2" : i == 3 ? "VEC4" : "VEC3";
    const int accessor = sample.accessor(0, i == 3 ? 5121 : 5126, type, sheet.size());
    sample.json["accessors"].back().erase("bufferView");
    if (i == 3) sample.json["accessors"].back()["normalized"] = true;
    sample.primitive()["attributes"][kNames[i]] = accessor;
    attributes[kNames[i]] = i;
  }
  sample.primitive()["indices"] = sample.accessor(0, 5123, "SCALAR", sheet.corners.size());
  sample.json["accessors"].back().erase("bufferView");
  sample.primitive()["extensions"]["KHR_draco_mesh_compression"] = {{"bufferView", view},
                                                                    {"attributes", attributes}};
  sample.json["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  add_picture(sample);
  return sample;
}

TEST(DracoGltf, TheStreamWithoutRoundingIsTheMesh) {
  expect_sheet(read(packed_by_draco(draco_of(Sheet(), draco::MESH_SEQUENTIAL_ENCODING, 0))), 0);
}

TEST(DracoGltf, EdgebreakersStreamIsTheMeshUpToItsRounding) {
  expect_sheet(read(packed_by_draco(draco_of(Sheet(), draco::MESH_EDGEBREAKER_ENCODING, 14))), 1e-4);
  expect_sheet(read(packed_by_draco(draco_of(Sheet(), draco::MESH_SEQUENTIAL_ENCODING, 14))), 1e-4);
}

// Mode 5 says how the unpacked indices would be read; the stream holds triangles.
TEST(DracoGltf, AStripIsPackedAsTriangles) {
  GltfSample sample = packed_by_draco(draco_of(Sheet(), draco::MESH_EDGEBREAKER_ENCODING, 14));
  sample.primitive()["mode"] = 5;
  expect_sheet(read(sample), 1e-4);
}

TEST(DracoGltf, AttributesThatTheStreamLacksAreTheFilesOwn) {
  GltfSample sample = packed_by_draco(draco_of(Sheet(), draco::MESH_SEQUENTIAL_ENCODING, 0));
  auto& attributes = sample.primitive()["extensions"]["KHR_draco_mesh_compression"]["attributes"];
  attributes.erase("COLOR_0");
  const int view = sample.view(bytes_of(Sheet().colors));
  sample.json["accessors"][3]["bufferView"] = view;
  expect_sheet(read(sample), 0);
}

TEST(DracoGltf, WhatDoesNotFitTheAccessorsIsRefused) {
  const std::string stream = draco_of(Sheet(), draco::MESH_EDGEBREAKER_ENCODING, 14);
  const std::string at = "/meshes/0/primitives/0/extensions/KHR_draco_mesh_compression";
  GltfSample sample = packed_by_draco(stream);
  sample.json["accessors"][1]["count"] = 100;
  EXPECT_SAYS(refused(sample), "/accessors/1: says 100 elements, but its Draco stream has 144");
  sample = packed_by_draco(stream);
  sample.json["accessors"][3]["type"] = "VEC3";
  EXPECT_SAYS(refused(sample), at + "/attributes/COLOR_0: its Draco stream has 4 components, its accessor 3");
  sample = packed_by_draco(stream);
  sample.primitive()["extensions"]["KHR_draco_mesh_compression"]["attributes"]["NORMAL"] = 9;
  EXPECT_SAYS(refused(sample), at + "/attributes/NORMAL: its Draco stream has no attribute 9");
  sample = packed_by_draco(stream);
  sample.primitive().erase("indices");
  EXPECT_SAYS(refused(sample), "is packed, but has no indices");
  EXPECT_SAYS(refused(packed_by_draco("DRAC")), at + ": its Draco stream is damaged: it has no header");
  EXPECT_SAYS(refused(packed_by_draco(stream.substr(0, 70))), at + ": its Draco stream is damaged: ");
  std::string old = stream;
  old[6] = 1;
  EXPECT_SAYS(refused(packed_by_draco(old)), at + ": its Draco stream has version 2.1; 2.2 is read");
}

// Counts of four bytes each, as the bit stream has them: seven bits to a byte.
TEST(DracoGltf, CountsBeyondTheStreamAreNotBelieved) {
  const std::string header("DRACO\2\2\1", 8), flags("\0\0", 2);
  const std::string counts = "\xff\xff\xff\x7f\xff\xff\xff\x7f";
  for (const std::string& method : {std::string(1, '\0'), std::string("\1")})
    EXPECT_SAYS(
        refused(packed_by_draco(header + method + flags + (method == "\1" ? std::string(1, '\0') : "") +
                                counts + std::string(64, '\1'))),
        "its Draco stream is damaged");
}

TEST(DracoGltf, DamagedStreamsAreSafe) {
  mutate_stream(draco_of(Sheet(), draco::MESH_EDGEBREAKER_ENCODING, 11), packed_by_draco, 800);
  mutate_stream(draco_of(Sheet(), draco::MESH_SEQUENTIAL_ENCODING, 11), packed_by_draco, 800);
}

double area_of(const Scene& s) {
  double sum = 0;
  for (const Triangle& t : s.triangles) {
    const dvec3 a = s.vertices[t.vertex[0]];
    sum += glm::length(glm::cross(s.vertices[t.vertex[1]] - a, s.vertices[t.vertex[2]] - a)) / 2;
  }
  return sum;
}

TEST(DracoGltf, ModelsFromElsewhereAreThoseWithoutPacking) {
  for (const auto& [packed, plain] :
       {std::pair{"2CylinderEngine_draco/2CylinderEngine.gltf", "2CylinderEngine.glb"},
        std::pair{"Box_Draco.glb", "Box.glb"}}) {
    const auto file = test::data_path(std::string("gltf/") + packed);
    KDRAY_NEED_DATA(file);
    const Scene a = load(file), b = load(test::data_path(std::string("gltf/") + plain));
    const double size = glm::length(b.bounds().extent());
    EXPECT_LT(glm::length(a.bounds().lo - b.bounds().lo), 1e-3 * size) << packed;
    EXPECT_LT(glm::length(a.bounds().hi - b.bounds().hi), 1e-3 * size) << packed;
    EXPECT_NEAR(area_of(a), area_of(b), 1e-3 * area_of(b)) << packed;
    EXPECT_LE(a.triangles.size(), b.triangles.size()) << packed;  // its packer dropped some without an area
  }
}

#else

TEST(DracoGltf, WithoutLibdracoTheLineSaysWhatToDo) {
  GltfSample sample = test::square();
  sample.json["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  EXPECT_SAYS(refused(sample), "built without; build it with libdraco-dev installed");
}

// Where the extension isn't required, the numbers are there without it.
TEST(DracoGltf, WithoutLibdracoTheUnpackedCopyIsRead) {
  GltfSample sample = test::square();
  sample.primitive()["extensions"]["KHR_draco_mesh_compression"] = {{"bufferView", 0}};
  EXPECT_EQ(read(sample).triangles.size(), 2u);
  sample.json["accessors"][0].erase("bufferView");
  EXPECT_SAYS(refused(sample), "build it with libdraco-dev installed");
}

#endif

#ifdef KDRAY_WITH_MESHOPT

enum class Codec { attributes, triangles, indices };

std::string encoded(Codec codec, const std::string& bytes, std::size_t stride) {
  const std::size_t n = bytes.size() / stride;
  std::vector<std::uint32_t> corners;
  for (std::size_t i = 0; codec != Codec::attributes && i < n; ++i) {
    std::uint16_t corner = 0;
    std::memcpy(&corner, bytes.data() + i * stride, 2);
    corners.push_back(corner);
  }
  std::string out(meshopt_encodeVertexBufferBound(n, std::max<std::size_t>(stride, 4)) +
                      meshopt_encodeIndexBufferBound(n - n % 3 + 3, 65536),
                  '\0');
  auto* const to = reinterpret_cast<unsigned char*>(out.data());
  if (codec == Codec::attributes)
    out.resize(meshopt_encodeVertexBuffer(to, out.size(), bytes.data(), n, stride));
  else if (codec == Codec::triangles)
    out.resize(meshopt_encodeIndexBuffer(to, out.size(), corners.data(), n));
  else
    out.resize(meshopt_encodeIndexSequence(to, out.size(), corners.data(), n));
  return out;
}

// Puts a view's bytes into a packed stream; the buffer without bytes that is left takes the view's place.
void pack(GltfSample& sample, std::size_t view, Codec codec, std::size_t stride,
          const std::string& filter = "", const std::string& name = "EXT_meshopt_compression",
          const std::string& stream = "") {
  json& v = sample.json["bufferViews"][view];
  json& buffer = sample.json["buffers"][v["buffer"].get<std::size_t>()];
  const std::string uri = buffer["uri"];
  const std::string bytes = gltf::decode_data_uri(uri).value();
  buffer.erase("uri");
  buffer["extensions"][name] = {{"fallback", true}};
  const std::string packed = stream.empty() ? encoded(codec, bytes, stride) : stream;
  const int at = sample.view(packed);
  const std::size_t of = sample.json["bufferViews"][static_cast<std::size_t>(at)]["buffer"];
  json& extension = sample.json["bufferViews"][view]["extensions"][name];
  extension = {{"buffer", of},
               {"byteLength", packed.size()},
               {"byteStride", stride},
               {"count", bytes.size() / stride},
               {"mode", codec == Codec::attributes  ? "ATTRIBUTES"
                        : codec == Codec::triangles ? "TRIANGLES"
                                                    : "INDICES"}};
  if (!filter.empty()) extension["filter"] = filter;
}

TEST(MeshoptGltf, IsTheMesh) {
  for (const std::string name : {"EXT_meshopt_compression", "KHR_meshopt_compression"}) {
    for (const Codec codec : {Codec::triangles, Codec::indices}) {
      GltfSample sample = plain(Sheet());
      sample.json["extensionsRequired"] = {name};
      pack(sample, 0, Codec::attributes, 12, "", name);
      pack(sample, 1, Codec::attributes, 12, "NONE", name);
      pack(sample, 2, Codec::attributes, 8, "", name);
      pack(sample, 3, Codec::attributes, 4, "", name);
      pack(sample, 4, codec, 2, "", name);
      expect_sheet(read(sample), 0);
    }
  }
}

// Normals as bytes, two coordinates on an octahedron; positions as mantissas with a shared exponent.
TEST(MeshoptGltf, FiltersAreApplied) {
  const Sheet sheet;
  std::vector<float> vectors;
  for (std::size_t i = 0; i < sheet.size(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) vectors.push_back(sheet.normals[3 * i + c]);
    vectors.push_back(0);
  }
  std::string octahedral(8 * sheet.size(), '\0'), exponential(12 * sheet.size(), '\0');
  meshopt_encodeFilterOct(octahedral.data(), sheet.size(), 8, 16, vectors.data());
#if MESHOPTIMIZER_VERSION >= 200
  meshopt_encodeFilterExp(exponential.data(), sheet.size(), 12, 20, sheet.positions.data(),
                          meshopt_EncodeExpSharedVector);
#else
  meshopt_encodeFilterExp(exponential.data(), sheet.size(), 12, 20, sheet.positions.data());
#endif
  GltfSample sample = plain(sheet);
  const int view = sample.view(octahedral, 8);
  auto& accessor = sample.json["accessors"][1];
  accessor["bufferView"] = view;
  accessor["componentType"] = 5122;
  accessor["normalized"] = true;
  pack(sample, 0, Codec::attributes, 12, "EXPONENTIAL", "EXT_meshopt_compression",
       encoded(Codec::attributes, exponential, 12));
  pack(sample, static_cast<std::size_t>(view), Codec::attributes, 8, "OCTAHEDRAL");
  expect_sheet(read(sample), 1e-5);
}

TEST(MeshoptGltf, SizesThatDoNotFitAreRefused) {
  const std::string at = "/bufferViews/0/extensions/EXT_meshopt_compression";
  const auto with = [](const char* key, const json& value) {
    GltfSample sample = plain(Sheet());
    pack(sample, 0, Codec::attributes, 12);
    sample.json["bufferViews"][0]["extensions"]["EXT_meshopt_compression"][key] = value;
    return refused(sample);
  };
  EXPECT_SAYS(with("count", 143),
              at + ": its 143 elements of 12 bytes are not the 1728 bytes of its buffer view");
  EXPECT_SAYS(with("byteStride", 6), at + "/byteStride: expected a multiple of 4 up to 256");
  EXPECT_SAYS(with("byteStride", 260), at + "/byteStride: expected a multiple of 4 up to 256");
  EXPECT_SAYS(with("mode", "TRIANGLES"), at + "/byteStride: expected 2 or 4");
  EXPECT_SAYS(with("mode", "LINES"), at + "/mode: expected ATTRIBUTES, TRIANGLES or INDICES");
  EXPECT_SAYS(with("filter", "OCTAHEDRAL"), at + "/byteStride: expected 4 or 8 for this filter");
  EXPECT_SAYS(with("filter", "COLOR"), at + "/filter: the filter COLOR is not read; pack the file with EXT");
  EXPECT_SAYS(with("byteLength", 20), at + ": is damaged: 20 packed bytes can't hold 1728");
  EXPECT_SAYS(with("byteLength", 40), at + ": its stream is damaged");
  EXPECT_SAYS(with("byteLength", 99999), at + ": reaches to byte 99999");
}

TEST(MeshoptGltf, ANewerCodecIsNotTakenForAnOlderOne) {
  GltfSample sample = plain(Sheet());
  std::string stream = encoded(Codec::attributes, bytes_of(Sheet().positions), 12);
  stream[0] = static_cast<char>(0xa1);
  pack(sample, 0, Codec::attributes, 12, "", "KHR_meshopt_compression", stream);
  const std::string says = refused(sample);
  EXPECT_TRUE(says.find("of a codec that is not read") != std::string::npos ||
              says.find("damaged") != std::string::npos)
      << says;
}

// Views of one packed stream multiply it.
TEST(MeshoptGltf, AFileThatUnpacksToTooMuchIsRefused) {
  constexpr std::size_t kSize = std::size_t{1} << 24;
  const std::string stream = encoded(Codec::attributes, std::string(kSize, '\0'), 4);
  GltfSample sample = test::square();
  const int first = sample.view(stream);
  const std::size_t buffer = sample.json["bufferViews"][static_cast<std::size_t>(first)]["buffer"];
  for (int i = 0; i < 17; ++i) {
    json extension = {{"buffer", buffer},
                      {"byteLength", stream.size()},
                      {"byteStride", 4},
                      {"count", kSize / 4},
                      {"mode", "ATTRIBUTES"}};
    sample.json["bufferViews"].push_back({{"buffer", buffer},
                                          {"byteLength", kSize},
                                          {"extensions", {{"EXT_meshopt_compression", extension}}}});
    const int accessor =
        sample.accessor(static_cast<int>(sample.json["bufferViews"].size()) - 1, 5126, "VEC3", 4);
    json primitive = sample.primitive();
    primitive["attributes"]["NORMAL"] = accessor;
    sample.json["meshes"][0]["primitives"].push_back(primitive);
  }
  EXPECT_SAYS(refused(sample), "the file is unpacked to more than 64 times what was read of it");
}

TEST(MeshoptGltf, DamagedStreamsAreSafe) {
  const Sheet sheet;
  const auto positions = [&](const std::string& stream) {
    GltfSample sample = plain(sheet);
    pack(sample, 0, Codec::attributes, 12, "EXPONENTIAL", "EXT_meshopt_compression",
         stream.empty() ? "x" : stream);
    return sample;
  };
  mutate_stream(encoded(Codec::attributes, bytes_of(sheet.positions), 12), positions, 1500);
  for (const Codec codec : {Codec::triangles, Codec::indices}) {
    const auto corners = [&](const std::string& stream) {
      GltfSample sample = plain(sheet);
      pack(sample, 4, codec, 2, "", "EXT_meshopt_compression", stream.empty() ? "x" : stream);
      return sample;
    };
    mutate_stream(encoded(codec, bytes_of(sheet.corners), 2), corners, 1500);
  }
}

#else

TEST(MeshoptGltf, WithoutLibmeshoptimizerTheLineSaysWhatToDo) {
  GltfSample sample = test::square();
  sample.json["extensionsRequired"] = {"EXT_meshopt_compression"};
  EXPECT_SAYS(refused(sample), "built without; build it with libmeshoptimizer-dev installed");
}

TEST(MeshoptGltf, WithoutLibmeshoptimizerTheUnpackedCopyIsRead) {
  GltfSample sample = test::square();
  sample.json["bufferViews"][0]["extensions"]["EXT_meshopt_compression"] = {{"buffer", 0}};
  EXPECT_EQ(read(sample).triangles.size(), 2u);
  sample.json["buffers"][0].erase("uri");
  EXPECT_SAYS(refused(sample), "build it with libmeshoptimizer-dev installed");
}

#endif

}  // namespace
}  // namespace kdray::scene
