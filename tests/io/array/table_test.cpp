#include "io/array/table.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <vector>

#include "io/array/npy_header.h"
#include "kdray/ray.h"
#include "support/errors.h"
#include "support/folder.h"

namespace kdray::array {
namespace {

std::string written(const std::vector<Column>& columns, TableFormat format) {
  std::string bytes;
  write_table(columns, format, [&](std::string_view piece) { bytes += piece; });
  return bytes;
}

std::vector<Column> columns_of(const std::vector<Hit>& hits) {
  const std::span all(hits);
  return {column("t", all, &Hit::t), column("primitive", all, &Hit::primitive), column("u", all, &Hit::u),
          column("v", all, &Hit::v)};
}

// What of an .npy comes before its data, and the data.
struct Npy {
  explicit Npy(const std::string& bytes) {
    const NpyPreamble preamble = parse_preamble(bytes, "t.npy");
    header = parse_header(std::string_view(bytes).substr(preamble.bytes, preamble.header_bytes), "t.npy");
    data = bytes.substr(preamble.bytes + preamble.header_bytes);
  }
  NpyHeader header;
  std::string data;
};

TEST(Table, OfHitsIsWhatNumpyWrites) {
  const test::Folder folder;
  const std::vector<Hit> hits = {{1.5f, 7, 0.25f, 0.5f}, {INFINITY, -1, 0, 0}};
  write_table(folder / "h.npy", columns_of(hits), TableFormat::npy);
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

TEST(Table, HeadersAreAlignedAndReadBack) {
  for (const std::uint64_t n : {0ull, 9ull, 10ull, 99999ull, 18446744073709551615ull}) {
    const std::vector<std::uint64_t> shape = {n};
    const std::string header = make_header("'<f4'", shape);
    EXPECT_EQ(header.size() % 64, 0u);
    const Npy parsed(header);
    EXPECT_TRUE(parsed.data.empty());
    EXPECT_EQ(parsed.header.shape, shape);
    EXPECT_EQ(parsed.header.type, "<f4");
  }
}

// More rows than are gathered at a time, of columns that lie apart: record by record, with nothing between.
TEST(Table, RecordsArePackedWhereverTheirColumnsLie) {
  constexpr std::size_t kRows = 100003;
  std::vector<double> t(kRows);
  std::vector<std::array<float, 3>> point(kRows);
  std::vector<std::uint8_t> more(kRows);
  for (std::size_t i = 0; i < kRows; ++i) {
    const auto x = static_cast<float>(i);
    t[i] = 0.5 * static_cast<double>(i), point[i] = {x, x + 1, x + 2}, more[i] = i % 2;
  }
  const Npy npy(written({column("t", std::span<const double>(t)),
                         column("point", std::span<const std::array<float, 3>>(point)), flags("more", more)},
                        TableFormat::npy));
  EXPECT_EQ(npy.header.type, "[('t', '<f8'), ('point', '<f4', (3,)), ('more', '|b1')]");
  EXPECT_EQ(npy.header.shape, std::vector<std::uint64_t>{kRows});
  constexpr std::size_t kRecord = 8 + 12 + 1;
  ASSERT_EQ(npy.data.size(), kRows * kRecord);
  for (std::size_t i = 0; i < kRows; ++i) {
    const char* const record = npy.data.data() + i * kRecord;
    ASSERT_EQ(std::memcmp(record, &t[i], 8), 0) << i;
    ASSERT_EQ(std::memcmp(record + 8, &point[i], 12), 0) << i;
    ASSERT_EQ(record[20], more[i]) << i;
  }
}

TEST(Table, OneColumnIsAPlainArray) {
  const std::vector<std::uint32_t> counts = {3, 0, 4294967295u};
  const Npy npy(written({column("count", std::span<const std::uint32_t>(counts))}, TableFormat::npy));
  EXPECT_FALSE(npy.header.structured);
  EXPECT_EQ(npy.header.type, "<u4");
  EXPECT_EQ(npy.header.shape, std::vector<std::uint64_t>{3});
  EXPECT_EQ(std::memcmp(npy.data.data(), counts.data(), 12), 0);
  const std::vector<std::array<double, 3>> points(5);
  const Npy rows(
      written({column("point", std::span<const std::array<double, 3>>(points))}, TableFormat::npy));
  EXPECT_EQ(rows.header.shape, (std::vector<std::uint64_t>{5, 3}));
}

TEST(Table, NoRowsAreAFileToo) {
  EXPECT_NE(written(columns_of({}), TableFormat::npy).find("'shape': (0,)"), std::string::npos);
  EXPECT_NE(written(columns_of({}), TableFormat::npz).find("t.npy"), std::string::npos);
}

TEST(Table, ColumnsOfAnNpyHaveOneLength) {
  const std::vector<float> two(2), three(3);
  const std::vector<Column> columns = {column("a", std::span<const float>(two)),
                                       column("b", std::span<const float>(three))};
  EXPECT_TRUE(test::fails([&] { written(columns, TableFormat::npy); }, "lengths", ErrorCode::internal));
  EXPECT_NE(written(columns, TableFormat::npz).find("b.npy"), std::string::npos);
}

TEST(Table, AFileThatCannotBeWrittenIsNamedAndLeavesNothing) {
  const test::Folder folder;
  EXPECT_TRUE(test::fails([&] { write_table(folder / "no" / "h.npz", columns_of({}), TableFormat::npz); },
                          "does not exist"));
  const std::vector<Hit> hits(1 << 16);
  EXPECT_TRUE(
      test::fails([&] { write_table("/dev/full", columns_of(hits), TableFormat::npz); }, "the disk is full"));
  EXPECT_EQ(folder.n_entries(), 0u);
}

TEST(Table, OfTextHasTheNumbersToTheBit) {
  const std::vector<float> u = {0.1f, -INFINITY};
  const std::vector<double> t = {1.0 / 3, 1e300};
  const std::vector<std::array<double, 3>> points = {{1, 2, 3.5}, {-0.0, 0, NAN}};
  const std::vector<std::uint8_t> inside = {1, 0};
  const std::vector<std::int32_t> number = {-1, 7};
  EXPECT_EQ(written({column("t", std::span(t)), column("u", std::span(u)),
                     column("point", std::span<const std::array<double, 3>>(points)),
                     column("n", std::span(number)), flags("inside", inside)},
                    TableFormat::csv),
            "t,u,point_x,point_y,point_z,n,inside\n0.3333333333333333,0.1,1,2,3.5,-1,1\n1e+300,-inf,-0,0,nan,"
            "7,0\n");
  EXPECT_EQ(written({column("t", std::span<const double>())}, TableFormat::csv), "t\n");
}

}  // namespace
}  // namespace kdray::array
