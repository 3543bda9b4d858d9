#include "rays/npy.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>

#include "rays/npy_header.h"
#include "support/errors.h"
#include "support/folder.h"

namespace kdray::rays {
namespace {

using test::fails;

std::string file_of(const std::string& dictionary, const std::string& data, char version = 1) {
  std::string bytes = "\x93NUMPY";
  bytes +=
      {version, '\0', static_cast<char>(dictionary.size() & 255), static_cast<char>(dictionary.size() >> 8)};
  if (version > 1) bytes += {'\0', '\0'};
  return bytes + dictionary + data;
}

std::string ray_bytes(int n_rays) {
  std::vector<float> values;
  for (int i = 0; i < 8 * n_rays; ++i) values.push_back(static_cast<float>(i) + 0.25f);
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float)};
}

const std::string kDictionary = "{'descr': '<f4', 'fortran_order': False, 'shape': (3, 8), }\n";

TEST(ReadRays, ReadsEveryVersionAndSpelling) {
  const test::Folder folder;
  for (const char version : {1, 2, 3})
    for (const std::string dictionary :
         {kDictionary.c_str(), "{'descr':'<f4','fortran_order':False,'shape':(3,8)}",
          "  { \"shape\" : ( 3L , 8L ), 'fortran_order' :False ,\n'descr': \"<f4\" }   \n"}) {
      const auto rays = read_rays(folder.put("r.npy", file_of(dictionary, ray_bytes(3), version)));
      ASSERT_EQ(rays.size(), 3u) << dictionary;
      EXPECT_EQ(rays[0].origin[0], 0.25f);
      EXPECT_EQ(rays[1].t_min, 11.25f);
      EXPECT_EQ(rays[1].direction[2], 14.25f);
      EXPECT_EQ(rays[2].t_max, 23.25f);
    }
}

TEST(ReadRays, NoRaysAreRays) {
  const test::Folder folder;
  EXPECT_TRUE(
      read_rays(folder.put("r.npy", file_of("{'descr': '<f4', 'fortran_order': True, 'shape': (0, 8)}", "")))
          .empty());
}

TEST(ReadRays, RefusesOtherArraysAndSaysWhatToDo) {
  const test::Folder folder;
  const auto reading = [&](const std::string& type, const std::string& order, const std::string& shape) {
    const auto file = folder.put(
        "r.npy", file_of("{'descr': " + type + ", 'fortran_order': " + order + ", 'shape': " + shape + "}",
                         ray_bytes(3)));
    return [=] { read_rays(file); };
  };
  EXPECT_TRUE(fails(reading("'<f8'", "False", "(3, 8)"), "save rays.astype('<f4')"));
  EXPECT_TRUE(fails(reading("'>f4'", "False", "(3, 8)"), "save rays.astype('<f4')"));
  EXPECT_TRUE(fails(reading("'<f4'", "True", "(3, 8)"), "numpy.ascontiguousarray"));
  EXPECT_TRUE(fails(reading("'<f4'", "False", "(24,)"), "has the shape (24,)"));
  EXPECT_TRUE(fails(reading("'<f4'", "False", "()"), "has the shape ()"));
  EXPECT_TRUE(fails(reading("'<f4'", "False", "(4, 6)"), "has the shape (4, 6)"));
  EXPECT_TRUE(fails(reading("'<f4'", "False", "(1, 3, 8)"), "N x 8"));
  EXPECT_TRUE(
      fails(reading("[('o]', '<f4', (3,)), ('d', '<f4')]", "False", "(3,)"), "structured_to_unstructured"));
}

TEST(ReadRays, HoldsTheCountAgainstTheFile) {
  const test::Folder folder;
  const auto reading = [&](const std::string& shape, std::size_t n_bytes) {
    std::string data = ray_bytes(3);
    data.resize(n_bytes, 'x');
    const auto file = folder.put(
        "r.npy", file_of("{'descr': '<f4', 'fortran_order': False, 'shape': " + shape + "}", data));
    return [=] { read_rays(file); };
  };
  EXPECT_TRUE(fails(reading("(3, 8)", 95), "cut short"));
  EXPECT_TRUE(fails(reading("(3, 8)", 97), "save one array"));
  EXPECT_TRUE(fails(reading("(2, 8)", 96), "save one array"));
  // The product overflows 64 bits; so does the number itself.
  EXPECT_TRUE(fails(reading("(576460752303423488, 8)", 96), "cut short"));
  EXPECT_TRUE(fails(reading("(99999999999999999999999, 8)", 96), "too large"));
}

TEST(ReadRays, RefusesDamagedHeaders) {
  const test::Folder folder;
  for (const std::string dictionary :
       {"", "{", "{}", "{'descr': '<f4'}", "{'descr': '<f4', 'fortran_order': 0, 'shape': (3, 8)}",
        "{'descr': '<f4', 'fortran_order': False, 'shape': (3, -8)}",
        "{'descr': '<f4', 'fortran_order': False, 'shape': (3, 8), 'more': 1}",
        "{'descr': '<f4', 'descr': '<f4', 'fortran_order': False, 'shape': (3, 8)}",
        "{'descr': '<f4, 'fortran_order': False, 'shape': (3, 8)}",
        "{'descr': [('t', '<f4'), 'fortran_order': False, 'shape': (3, 8)",
        "{'descr': '<f4', 'fortran_order': False, 'shape': (3, 8)} x"}) {
    const auto file = folder.put("r.npy", file_of(dictionary, ray_bytes(3)));
    EXPECT_TRUE(fails([&] { read_rays(file); }, "header")) << dictionary;
  }
  EXPECT_TRUE(
      fails([&] { read_rays(folder.put("r.npy", file_of(kDictionary, ray_bytes(3), 9))); }, "version 9"));
  EXPECT_TRUE(fails([&] { read_rays(folder.put("r.npy", "PK\3\4 an npz is a zip")); }, "not a NumPy file"));
  EXPECT_TRUE(fails([&] { read_rays(folder / "none.npy"); }, "No such file"));
  EXPECT_TRUE(fails([&] { read_rays(folder.path()); }, "is a folder"));
}

TEST(ReadRays, EveryTruncationAndDamageIsRefusedOrRead) {
  const test::Folder folder;
  const std::string whole = file_of(kDictionary, ray_bytes(3), 2);
  for (std::size_t n = 0; n < whole.size(); ++n)
    EXPECT_TRUE(fails([&] { read_rays(folder.put("r.npy", whole.substr(0, n))); }, "r.npy: ")) << n;
  constexpr unsigned kSeed = 11;
  std::mt19937 random(kSeed);
  for (int i = 0; i < 300; ++i) {
    std::string bytes = whole;
    bytes[random() % 72] = static_cast<char>(random());
    try {
      EXPECT_EQ(read_rays(folder.put("r.npy", bytes)).size(), 3u) << "seed " << kSeed;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::input) << "seed " << kSeed;
    }
  }
}

TEST(WriteHits, IsWhatNumpyWrites) {
  const test::Folder folder;
  const std::vector<Hit> hits = {{1.5f, 7, 0.25f, 0.5f}, {INFINITY, -1, 0, 0}};
  write_hits(folder / "h.npy", hits);
  const std::string bytes = folder.get("h.npy");
  // The dictionary as numpy.save writes it for such an array; how far it pads is left open by the format.
  const std::string text =
      "{'descr': [('t', '<f4'), ('primitive', '<i4'), ('u', '<f4'), ('v', '<f4')], "
      "'fortran_order': False, 'shape': (2,), }";
  ASSERT_GT(bytes.size(), 2 * sizeof(Hit));
  const std::size_t begin = bytes.size() - 2 * sizeof(Hit);
  EXPECT_EQ(begin % 64, 0u);
  EXPECT_EQ(bytes.substr(0, 8), std::string("\x93NUMPY\x01\x00", 8));
  EXPECT_EQ(bytes.substr(10, text.size()), text);
  EXPECT_EQ(bytes.find_first_not_of(' ', 10 + text.size()), begin - 1);
  EXPECT_EQ(bytes[begin - 1], '\n');
  EXPECT_EQ(std::memcmp(bytes.data() + begin, hits.data(), 2 * sizeof(Hit)), 0);
}

TEST(WriteHits, HeadersAreAlignedAndReadBack) {
  for (std::uint64_t n : {0ull, 9ull, 10ull, 99999ull, 18446744073709551615ull}) {
    const std::string header = make_header("'<f4'", n);
    EXPECT_EQ(header.size() % 64, 0u);
    const NpyPreamble preamble = parse_preamble(header, "h.npy");
    EXPECT_EQ(preamble.bytes + preamble.header_bytes, header.size());
    const NpyHeader parsed = parse_header(std::string_view(header).substr(preamble.bytes), "h.npy");
    EXPECT_EQ(parsed.shape, std::vector<std::uint64_t>{n});
    EXPECT_EQ(parsed.type, "<f4");
  }
}

TEST(WriteHits, NoHitsAreAFileToo) {
  const test::Folder folder;
  write_hits(folder / "h.npy", {});
  EXPECT_NE(folder.get("h.npy").find("'shape': (0,)"), std::string::npos);
}

}  // namespace
}  // namespace kdray::rays
