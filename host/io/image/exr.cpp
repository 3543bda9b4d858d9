// Shape   A header's size is not believed when reading: sides are limited, and rows are read and appended a
//         block at a time, so that a header that promises too much fails before much is allocated for it.
#include "io/image/exr.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfStdIO.h>
#include <ImfStringAttribute.h>
#include <ImfThreading.h>

#include <algorithm>
#include <cstring>
#include <thread>

#include "base/error.h"

namespace kdray::image {

namespace {

int exr_threads() {
  static const int n_threads = [] {
    const int n = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
    // 1 thread means none beside the caller's.
    if (Imf::globalThreadCount() == 0 && n > 1) Imf::setGlobalThreadCount(n);
    return n > 1 ? n : 0;
  }();
  return n_threads;
}

}  // namespace

// ---- reading

namespace {

constexpr int kMaxSide = 1 << 16;
constexpr int kRowsAtOnce = 256;  // the most lines that one of OpenEXR's compressed blocks holds

class MemoryStream : public Imf::IStream {
 public:
  MemoryStream(std::string_view bytes, const std::string& name) : IStream(name.c_str()), bytes_(bytes) {}

  bool read(char c[], int n) override {
    if (n < 0 || static_cast<std::uint64_t>(n) > bytes_.size() - std::min(position_, bytes_.size()))
      throw Iex::InputExc("the file is cut short");
    std::memcpy(c, bytes_.data() + position_, static_cast<std::size_t>(n));
    position_ += static_cast<std::size_t>(n);
    return position_ < bytes_.size();
  }
  uint64_t tellg() override { return position_; }
  void seekg(uint64_t position) override { position_ = position; }
  void clear() override {}

 private:
  std::string_view bytes_;
  std::size_t position_ = 0;
};

// The names of the channels that hold red, green and blue.
struct ColorNames {
  const char* name[3];
  bool alpha;
};

ColorNames find_color(const Imf::ChannelList& channels, const std::string& file) {
  const auto has = [&](const char* name) { return channels.findChannel(name) != nullptr; };
  if (has("R") && has("G") && has("B")) return {{"R", "G", "B"}, has("A")};
  if (has("RY") || has("BY"))
    throw input_error(file, 0, "holds luminance and chroma", "convert it to an EXR with R, G and B");
  if (has("Y")) return {{"Y", "Y", "Y"}, has("A")};
  std::string found;
  for (auto c = channels.begin(); c != channels.end() && found.size() < 60; ++c)
    found += std::string(found.empty() ? "" : ", ") + c.name();
  throw input_error(file, 0,
                    "has no channels R, G and B or Y (it has " + (found.empty() ? "none" : found) + ")",
                    "name an EXR with colour");
}

void check_sides(std::int64_t width, std::int64_t height, const std::string& file) {
  if (width < 1 || height < 1 || width > kMaxSide || height > kMaxSide)
    throw input_error(file, 0,
                      "says it is " + std::to_string(width) + " x " + std::to_string(height) + " pixels",
                      "a side may have 1 to " + std::to_string(kMaxSide));
}

// Reads the rows [first, last) of the window to the end of image.pixels.
void append_rows(Imf::InputFile& input, const ColorNames& names, int left, int first, int last,
                 Image& image) {
  const auto width = static_cast<std::size_t>(image.width);
  const std::size_t n_before = image.pixels.size();
  image.pixels.resize(n_before + width * static_cast<std::size_t>(last - first), vec3(0));
  Imf::FrameBuffer frame;
  const auto insert = [&](const char* name, float* first_value, std::size_t step) {
    // OpenEXR wants the address that pixel (0, 0) would have. It may lie outside, so it is computed as a
    // number.
    const auto origin =
        reinterpret_cast<std::intptr_t>(first_value) -
        (static_cast<std::intptr_t>(first) * image.width + left) * static_cast<std::intptr_t>(step);
    frame.insert(name, Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(origin), step, step * width));
  };
  const bool grey = std::strcmp(names.name[0], names.name[1]) == 0;
  for (int c = 0; c < (grey ? 1 : 3); ++c) insert(names.name[c], &image.pixels[n_before].x + c, sizeof(vec3));
  if (names.alpha) {
    image.alpha.resize(image.pixels.size(), 0);
    insert("A", &image.alpha[n_before], sizeof(float));
  }
  input.setFrameBuffer(frame);
  input.readPixels(first, last - 1);
  if (grey)
    for (std::size_t i = n_before; i < image.pixels.size(); ++i) image.pixels[i] = vec3(image.pixels[i].x);
}

// Looks at the first header, the picture's, before OpenEXR makes buffers as wide as it says.
void check_header(std::string_view bytes, const std::string& file, std::uint64_t most) {
  MemoryStream stream(bytes, file);
  int version = 0;
  for (std::size_t i = 4; i-- > 0;) version = version << 8 | static_cast<unsigned char>(bytes[4 + i]);
  stream.seekg(8);
  Imf::Header header;
  header.readFrom(stream, version);
  const auto window = header.dataWindow();
  const std::int64_t width = std::int64_t{window.max.x} - window.min.x + 1;
  const std::int64_t height = std::int64_t{window.max.y} - window.min.y + 1;
  check_sides(width, height, file);
  if (static_cast<std::uint64_t>(width * height) > most)
    throw input_error(file, 0,
                      "says it is " + std::to_string(width) + " x " + std::to_string(height) + " pixels",
                      "make it smaller: " + std::to_string(most) + " are the most");
}

Image read_all(std::string_view bytes, const std::string& file, std::uint64_t most) {
  check_header(bytes, file, most);
  MemoryStream stream(bytes, file);
  Imf::InputFile input(stream, exr_threads());
  const auto window = input.header().dataWindow();
  const ColorNames names = find_color(input.header().channels(), file);
  Image image;
  image.width = window.max.x - window.min.x + 1, image.height = window.max.y - window.min.y + 1;
  for (int row = 0; row < image.height; row += kRowsAtOnce)
    append_rows(input, names, window.min.x, window.min.y + row,
                window.min.y + std::min(row + kRowsAtOnce, image.height), image);
  return image;
}

}  // namespace

Image decode_exr(std::string_view bytes, const std::string& file, std::uint64_t most) {
  // OpenEXR allocates line buffers from the header before a caller can see it, so it needs the limit itself.
  static const bool limited = (Imf::Header::setMaxImageSize(kMaxSide, kMaxSide), true);
  static_cast<void>(limited);
  static constexpr char kMagic[] = {0x76, 0x2f, 0x31, 0x01};
  if (bytes.size() < 8 || std::memcmp(bytes.data(), kMagic, 4) != 0)
    throw input_error(file, 0, "is not an OpenEXR file", "name a PNG or EXR picture");
  try {
    return read_all(bytes, file, most);
  } catch (const Error&) {
    throw;
  } catch (const std::exception& e) {
    throw input_error(file, 0, std::string("is a damaged OpenEXR file: ") + e.what(), "write it again");
  }
}

// ---- writing

namespace {

// OpenEXR takes the address that pixel (0, 0) of the whole picture would have, which may lie outside, and
// strides; it does not write through the pointer of an output slice.
Imf::Slice slice(const float* values, std::size_t step, const Image& image) {
  const std::size_t bytes = step * sizeof(float), row = bytes * static_cast<std::size_t>(image.width);
  const auto before = static_cast<std::size_t>(image.y) * row + static_cast<std::size_t>(image.x) * bytes;
  return {Imf::FLOAT, reinterpret_cast<char*>(reinterpret_cast<std::uintptr_t>(values) - before), bytes, row};
}

Imf::Header header_of(const Image& image) {
  if (image.whole_width == 0) return {image.width, image.height};
  const Imath::Box2i part(Imath::V2i(image.x, image.y),
                          Imath::V2i(image.x + image.width - 1, image.y + image.height - 1));
  const Imath::Box2i whole(Imath::V2i(0, 0), Imath::V2i(image.whole_width - 1, image.whole_height - 1));
  return {whole, part};
}

}  // namespace

std::string exr_name(const std::string& channel) {
  if (channel == "depth") return "Z";
  if (channel == "normal.x") return "N.X";
  if (channel == "normal.y") return "N.Y";
  if (channel == "normal.z") return "N.Z";
  return channel;
}

std::string encode_exr(const Image& image, std::span<const Channel> channels) {
  static_assert(sizeof(vec3) == 3 * sizeof(float));
  Imf::Header header = header_of(image);
  header.compression() = Imf::ZIP_COMPRESSION;
  Imf::FrameBuffer frame;
  const auto add = [&](const std::string& name, const float* values, std::size_t step) {
    header.channels().insert(name, Imf::Channel(Imf::FLOAT));
    frame.insert(name, slice(values, step, image));
  };
  const float* rgb = &image.pixels.data()->x;
  add("R", rgb, 3), add("G", rgb + 1, 3), add("B", rgb + 2, 3);
  if (!image.alpha.empty()) add("A", image.alpha.data(), 1);
  for (const Channel& channel : channels) {
    add(exr_name(channel.name), channel.values.data(), 1);
    if (!channel.manifest.empty())
      header.insert("kdray/" + exr_name(channel.name) + "/manifest", Imf::StringAttribute(channel.manifest));
  }

  Imf::StdOSStream stream;
  try {
    // The file is complete only when its destructor has written the table of lines.
    Imf::OutputFile file(stream, header, exr_threads());
    file.setFrameBuffer(frame);
    file.writePixels(image.height);
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& e) {
    throw Error(ErrorCode::internal, std::string("OpenEXR could not encode the picture: ") + e.what());
  }
  return stream.str();
}

}  // namespace kdray::image
