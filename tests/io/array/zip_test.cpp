// What    Archives of ZipWriter as Python's zipfile reads them, which shares no code with it: names, sizes,
//         places, checksums, with the fields of zip64 and without.
#include "io/array/zip.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <map>

#include "support/folder.h"

namespace kdray::array {
namespace {

std::string zip_of(const std::map<std::string, std::string>& files, std::uint64_t zip64_from = 0xffffffffu) {
  std::string bytes;
  ZipWriter zip([&](std::string_view piece) { bytes += piece; }, zip64_from);
  for (const auto& [name, content] : files)
    zip.add(name, [&, text = std::string_view(content)](const Sink& sink) {
      sink(text.substr(0, text.size() / 3));  // in pieces, one of which may be empty
      sink("");
      sink(text.substr(text.size() / 3));
    });
  zip.finish();
  return bytes;
}

bool has_python() {
  return std::system("python3 -c 'import zipfile' > /dev/null 2>&1") == 0;
}

// Unpacks the archive with Python into the folder `out` beside it, after it has checked all checksums.
bool unpack(const test::Folder& folder, const std::string& bytes) {
  folder.put("a.zip", bytes);
  const std::string command = "cd '" + folder.path().string() +
                              "' && rm -rf out && python3 -c \"import zipfile as z\n"
                              "a = z.ZipFile('a.zip')\nassert a.testzip() is None\n"
                              "assert all(i.compress_type == z.ZIP_STORED for i in a.infolist())\n"
                              "a.extractall('out')\"";
  return std::system(command.c_str()) == 0;
}

TEST(Zip, PythonUnpacksWhatWasPacked) {
  if (!has_python()) GTEST_SKIP() << "no python3";
  const test::Folder folder;
  const std::map<std::string, std::string> files = {
      {"empty.npy", ""}, {"one.npy", "x"}, {"t.npy", std::string(300000, 't') + std::string("\0\xff", 2)}};
  // 40 has large files, near and far; 0 all; 1000 places alone.
  for (const std::uint64_t zip64_from : {0xffffffffull, 0ull, 40ull, 1000ull}) {
    ASSERT_TRUE(unpack(folder, zip_of(files, zip64_from))) << zip64_from;
    for (const auto& [name, content] : files)
      EXPECT_EQ(folder.get("out/" + name), content) << name << " " << zip64_from;
  }
}

TEST(Zip, NoFilesAreAnArchiveToo) {
  EXPECT_EQ(zip_of({}), std::string("PK\5\6", 4) + std::string(18, '\0'));
}

TEST(Zip, TheSameFilesMakeTheSameBytes) {
  EXPECT_EQ(zip_of({{"a.npy", "1"}, {"b.npy", "2"}}), zip_of({{"a.npy", "1"}, {"b.npy", "2"}}));
}

// What of a file of 5 GiB goes by, in an archive that nobody keeps: its sizes and the place of the next one
// are in zip64's fields.
TEST(Zip, LargeFilesHaveTheirSizesBeside) {
  constexpr std::uint64_t kPieces = 5120;
  const std::string piece(std::size_t{1} << 20, 'p');
  std::string tail;
  ZipWriter zip([&](std::string_view bytes) {
    if (bytes.size() < piece.size()) tail += bytes;
  });
  zip.add("large.npy", [&](const Sink& sink) {
    for (std::uint64_t i = 0; i < kPieces; ++i) sink(piece);
  });
  zip.add("small.npy", [](const Sink& sink) { sink("s"); });
  zip.finish();
  const auto word64 = [&](std::uint64_t value) {
    return std::string(reinterpret_cast<const char*>(&value), sizeof value);
  };
  const std::string size = word64(kPieces << 20);
  EXPECT_NE(tail.find(std::string("\1\0\x10\0", 4) + size + size), std::string::npos);
  // The next file begins behind the header (30), the name (9), zip64's fields (20) and the file.
  EXPECT_NE(tail.find(std::string("\1\0\x08\0", 4) + word64((kPieces << 20) + 59)), std::string::npos);
  EXPECT_NE(tail.find("PK\6\6"), std::string::npos);
}

}  // namespace
}  // namespace kdray::array
