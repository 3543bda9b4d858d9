#include "scene/import/files.h"

#include <lzma.h>
#include <zlib.h>

#include <random>

#include "scene/scratch.h"

namespace kdray::scene {
namespace {

using test::refusal;
using test::ScratchFolder;

std::string gzip(const std::string& text) {
  z_stream stream{};
  EXPECT_EQ(deflateInit2(&stream, 6, Z_DEFLATED, 16 + MAX_WBITS, 8, Z_DEFAULT_STRATEGY), Z_OK);
  std::string out(deflateBound(&stream, text.size()), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data()));
  stream.avail_in = static_cast<uInt>(text.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  EXPECT_EQ(deflate(&stream, Z_FINISH), Z_STREAM_END);
  out.resize(stream.total_out);
  deflateEnd(&stream);
  return out;
}

std::string xz(const std::string& text, std::uint32_t preset = 1) {
  std::string out(lzma_stream_buffer_bound(text.size()), '\0');
  std::size_t size = 0;
  EXPECT_EQ(lzma_easy_buffer_encode(preset, LZMA_CHECK_CRC64, nullptr,
                                    reinterpret_cast<const std::uint8_t*>(text.data()), text.size(),
                                    reinterpret_cast<std::uint8_t*>(out.data()), &size, out.size()),
            LZMA_OK);
  out.resize(size);
  return out;
}

// Longer than the reader's chunk and not compressible away.
std::string noise(std::size_t n) {
  std::mt19937 random(7);
  std::string text(n, '\0');
  for (char& c : text) c = static_cast<char>(random() & 63);
  return text;
}

TEST(ReadFile, GivesTheBytesOfPlainGzAndXzFiles) {
  const ScratchFolder folder;
  const std::string text = noise(700'001);
  EXPECT_EQ(read_file(folder.write("a.nff", text)), text);
  EXPECT_EQ(read_file(folder.write("a.nff.gz", gzip(text))), text);
  EXPECT_EQ(read_file(folder.write("a.nff.XZ", xz(text))), text);
  EXPECT_EQ(read_file(folder.write("empty.nff", "")), "");
  EXPECT_EQ(read_file(folder.write("empty.nff.gz", gzip(""))), "");
  EXPECT_EQ(read_file(folder.write("empty.nff.xz", xz(""))), "");
}

TEST(ReadFile, JoinsTheMembersOfAPackedFile) {
  const ScratchFolder folder;
  EXPECT_EQ(read_file(folder.write("a.gz", gzip("one ") + gzip("two") + std::string(512, '\0'))), "one two");
  EXPECT_EQ(read_file(folder.write("a.xz", xz("one ") + xz("two"))), "one two");
}

TEST(ReadFile, RefusesEveryTruncation) {
  const ScratchFolder folder;
  const std::string text = noise(3000);
  for (const std::string ending : {".gz", ".xz"}) {
    const std::string packed = ending == ".gz" ? gzip(text) : xz(text);
    for (std::size_t n = 0; n < packed.size(); n += 7) {
      const std::string message =
          refusal([&] { read_file(folder.write("cut" + ending, packed.substr(0, n))); });
      EXPECT_NE(message.find("damaged"), std::string::npos) << n << ": " << message;
    }
  }
}

TEST(ReadFile, NeverTakesAFlippedByteForGood) {
  const ScratchFolder folder;
  const std::string text = noise(500);
  for (const std::string ending : {".gz", ".xz"}) {
    const std::string packed = ending == ".gz" ? gzip(text) : xz(text);
    for (std::size_t i = 0; i < packed.size(); ++i) {
      std::string bad = packed;
      bad[i] = static_cast<char>(bad[i] ^ 0x20);
      try {  // bytes without meaning (a date) may differ; the text may not
        EXPECT_EQ(read_file(folder.write("bad" + ending, bad)), text) << i;
      } catch (const Error& e) {
        EXPECT_EQ(e.code(), ErrorCode::input);
      }
    }
  }
}

TEST(ReadFile, StopsAtTheSizeLimit) {
  const ScratchFolder folder;
  const std::string zeros(3'000'000, '\0');
  for (const auto& [name, bytes] : {std::pair{"a.gz", gzip(zeros)}, {"a.xz", xz(zeros)}, {"a.nff", zeros}}) {
    const auto file = folder.write(name, bytes);
    EXPECT_EQ(read_file(file, zeros.size()).size(), zeros.size());
    EXPECT_NE(refusal([&] { read_file(file, zeros.size() - 1); }).find("larger than 2999999 bytes"),
              std::string::npos);
  }
}

// A header of a few bytes may ask for a window of 4 GiB.
TEST(ReadFile, RefusesAnXzWindowOutOfProportion) {
  const ScratchFolder folder;
  lzma_stream stream = LZMA_STREAM_INIT;
  ASSERT_EQ(lzma_easy_encoder(&stream, 0, LZMA_CHECK_CRC32), LZMA_OK);
  std::string packed(1000, '\0');
  const std::string text = "s 0 0 0 1";
  stream.next_in = reinterpret_cast<const std::uint8_t*>(text.data());
  stream.avail_in = text.size();
  stream.next_out = reinterpret_cast<std::uint8_t*>(packed.data());
  stream.avail_out = packed.size();
  ASSERT_EQ(lzma_code(&stream, LZMA_FINISH), LZMA_STREAM_END);
  packed.resize(packed.size() - stream.avail_out);
  lzma_end(&stream);
  ASSERT_EQ(read_file(folder.write("small.xz", packed)), text);
  // The block header follows the stream header of 12 bytes: size, flags, filter, size of its properties,
  // window.
  auto* header = reinterpret_cast<std::uint8_t*>(packed.data()) + 12;
  const std::size_t size = (header[0] + 1u) * 4u;
  ASSERT_EQ(header[2], 0x21) << "LZMA2";
  header[4] = 40;  // 4 GiB - 1
  const std::uint32_t crc = lzma_crc32(header, size - 4, 0);
  for (std::size_t i = 0; i < 4; ++i) header[size - 4 + i] = static_cast<std::uint8_t>(crc >> (8 * i));
  EXPECT_NE(refusal([&] { read_file(folder.write("large.xz", packed)); }).find("more than 256 MiB"),
            std::string::npos);
}

TEST(ReadFile, SaysWhatIsWrongWithTheName) {
  const ScratchFolder folder;
  EXPECT_NE(refusal([&] { read_file(folder / "none.nff"); }).find("none.nff: no such file"),
            std::string::npos);
  EXPECT_NE(refusal([&] { read_file(folder / "."); }).find("is a folder"), std::string::npos);
  EXPECT_NE(refusal([&] { read_file(folder.write("a.gz", "plain text")); }).find("not gzip data"),
            std::string::npos);
  EXPECT_NE(refusal([&] { read_file(folder.write("a.xz", "plain text, not packed")); }).find("not xz data"),
            std::string::npos);
}

TEST(FormatOf, IsTheEndingBelowTheCompression) {
  EXPECT_EQ(format_of("a/b.c/dragon.PLY.xz"), ".ply");
  EXPECT_EQ(format_of("x.nff.gz"), ".nff");
  EXPECT_EQ(format_of("x.glb"), ".glb");
  EXPECT_EQ(format_of("x.gz"), "");
  EXPECT_EQ(format_of("x"), "");
  EXPECT_EQ(format_of("a.b/x"), "");
}

}  // namespace
}  // namespace kdray::scene
