#include "io/array/rows_file.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <random>

#include "kdray/ray.h"
#include "support/errors.h"
#include "support/folder.h"

namespace kdray::array {
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

std::vector<Ray> read_rays(const std::filesystem::path& file) {
  return RowsFile(file, kRays).read<Ray>();
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

TEST(ReadRows, DoublesAndPointsAreReadAsTheyAre) {
  const test::Folder folder;
  const std::array<double, 8> ray = {1e300, 0.1, -0.1, 1e-300, 1, 2, 3, HUGE_VAL};
  const std::string bytes(reinterpret_cast<const char*>(ray.data()), sizeof ray);
  RowsFile rays(
      folder.put("r.npy", file_of("{'descr': '<f8', 'fortran_order': True, 'shape': (1, 8)}", bytes)), kRays);
  EXPECT_TRUE(rays.in_double());
  EXPECT_EQ(rays.row_bytes(), 64u);
  EXPECT_EQ((rays.read<std::array<double, 8>>()), std::vector{ray});
  EXPECT_EQ((rays.read<std::array<double, 8>>()), std::vector{ray}) << "a second time";
  EXPECT_TRUE(fails([&] { rays.read<Ray>(); }, "another size", ErrorCode::internal));

  const auto file =
      folder.put("p.npy", file_of("{'descr': '<f4', 'fortran_order': False, 'shape': (8, 3)}", ray_bytes(3)));
  RowsFile points(file, kPoints);
  EXPECT_FALSE(points.in_double());
  ASSERT_EQ(points.size(), 8u);
  EXPECT_EQ((points.read<std::array<float, 3>>()[7]), (std::array{21.25f, 22.25f, 23.25f}));
  EXPECT_TRUE(fails([&] { RowsFile(file, kRays); }, "has the shape (8, 3) but rays are N x 8"));
}

TEST(ReadRays, RefusesOtherArraysAndSaysWhatToDo) {
  const test::Folder folder;
  const auto reading = [&](const std::string& type, const std::string& order, const std::string& shape) {
    const auto file = folder.put(
        "r.npy", file_of("{'descr': " + type + ", 'fortran_order': " + order + ", 'shape': " + shape + "}",
                         ray_bytes(3)));
    return [=] { read_rays(file); };
  };
  EXPECT_TRUE(fails(reading("'<f2'", "False", "(3, 8)"), "save rays.astype('<f4')"));
  EXPECT_TRUE(fails(reading("'>f4'", "False", "(3, 8)"), "save rays.astype('<f4')"));
  EXPECT_TRUE(fails(reading("'>f8'", "False", "(3, 8)"), "save rays.astype('<f8')"));
  EXPECT_TRUE(fails(reading("'|O'", "False", "(3, 8)"), "holds the type '|O'"));
  EXPECT_TRUE(fails(reading("'<f4'", "True", "(3, 8)"), "numpy.ascontiguousarray"));
  EXPECT_TRUE(fails(reading("'<f4'", "False", "(24,)"), "has the shape (24,)"));
  EXPECT_TRUE(fails(reading("'<f4'", "False", "()"), "has the shape ()"));
  EXPECT_TRUE(fails(reading("'<f4'", "False", "(4, 7)"), "has the shape (4, 7)"));
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

std::vector<std::array<double, 8>> read_doubles(const std::filesystem::path& file) {
  RowsFile rows(file, kRays);
  EXPECT_TRUE(rows.in_double());
  return rows.read<std::array<double, 8>>();
}

TEST(ReadRays, ReadsTexts) {
  const test::Folder folder;
  const std::array<double, 8> first{0.1, -2, 3e-300, 0, 1, 0, -1, INFINITY}, second{1, 2, 3, 0.5, 4, 5, 6, 7};
  EXPECT_EQ(read_doubles(folder.put("r.txt", "# rays\n0.1 -2 +3e-300 0 1 0 -1 inf\n\n1 2 3 0.5 4 5 6 7#c")),
            (std::vector{first, second}));
  EXPECT_EQ(
      read_doubles(folder.put("r.csv", "ox,oy,oz,t_min,dx,dy,dz,t_max\r\n0.1,-2, 3e-300,0,1,0,-1,inf\r\n")),
      std::vector{first});
  EXPECT_EQ(read_doubles(folder.put("r.csv", "0.1;-2;3e-300;1;0;-1\n")), std::vector{first});
  EXPECT_EQ(read_doubles(folder.put("r.csv", "\xef\xbb\xbf# \xc3\xa9\nx,\xc3\xa9\n0.1,-2,3e-300,1,0,-1\n")),
            std::vector{first});
  EXPECT_EQ(RowsFile(folder.put("p.xyz", "1\t2\t3\n"), kPoints).size(), 1u);
}

TEST(ReadRays, SaysWhatIsWrongWithTexts) {
  const test::Folder folder;
  const auto says = [&](const std::string& text, const std::string& what) {
    return fails([&] { read_rays(folder.put("r.txt", text)); }, what, ErrorCode::input);
  };
  EXPECT_TRUE(says("x y z\n1 2 3 a 5 6\n", "r.txt:2: 'a' is no number"));
  EXPECT_TRUE(says("1 2 3 4 5 6\n1 2 3\n", "r.txt:2: has 3 numbers, and the lines before it 6"));
  EXPECT_TRUE(says("1 2 3\n", "has 3 to a line but rays have 8"));
  EXPECT_TRUE(says("1 2 3 4 5 1e400\n", "r.txt:1: '1e400' is no number that a double holds"));
  EXPECT_TRUE(says("0.2.1 1 1 1 1 1\n1 2 3 4 5 6\n", "r.txt:1: '0.2.1' is no number"));
  EXPECT_TRUE(says("1.0D+00 1 1 1 1 1\n", "r.txt:1: '1.0D+00' is no number"));
  EXPECT_TRUE(says("x 1 1 1 1 1\n", "r.txt:1: 'x' is no number"));
  EXPECT_TRUE(says("+-1 1 1 1 1 1\n", "'+-1' is no number"));
  EXPECT_TRUE(says("1,,2,3,4,5,6\n", "r.txt:1: nothing stands between two commas"));
  EXPECT_TRUE(says("1,2,3,4,5,6,\n", "nothing stands"));
  EXPECT_TRUE(says("1 2 3 4 5 \xc3\xa9\n", "?' is no number"));
  EXPECT_TRUE(says("", "is empty"));
  EXPECT_TRUE(says("# nothing\n", "has no line of numbers"));
  EXPECT_TRUE(says("1 2 3 4 5 6 7 8\n\x01\x02", "neither a NumPy file nor a text"));
}

TEST(ReadRays, WithoutIntervalsGoFromTheStartOn) {
  const test::Folder folder;
  const std::vector<float> values = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
  const std::string data(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float));
  const auto rays = read_rays(
      folder.put("r.npy", file_of("{'descr': '<f4', 'fortran_order': False, 'shape': (2, 6), }", data)));
  ASSERT_EQ(rays.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    const auto first = static_cast<float>(6 * i);
    EXPECT_EQ(rays[i].origin[0], first + 1);
    EXPECT_EQ(rays[i].t_min, 0);
    EXPECT_EQ(rays[i].direction[2], first + 6);
    EXPECT_EQ(rays[i].t_max, INFINITY);
  }
}

}  // namespace
}  // namespace kdray::array
