#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfStdIO.h>

#include <algorithm>
#include <thread>

#include "base/error.h"
#include "io/image/exr.h"
#include "io/image/exr_threads.h"

namespace kdray::image {
namespace {

// OpenEXR takes a base pointer and strides; it does not write through the pointer of an output slice.
Imf::Slice slice(const float* values, std::size_t step, int width) {
  return {Imf::FLOAT, const_cast<char*>(reinterpret_cast<const char*>(values)), step * sizeof(float),
          step * sizeof(float) * static_cast<std::size_t>(width)};
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
  Imf::Header header(image.width, image.height);
  header.compression() = Imf::ZIP_COMPRESSION;
  Imf::FrameBuffer frame;
  const auto add = [&](const std::string& name, const float* values, std::size_t step) {
    header.channels().insert(name, Imf::Channel(Imf::FLOAT));
    frame.insert(name, slice(values, step, image.width));
  };
  const float* rgb = &image.pixels.data()->x;
  add("R", rgb, 3), add("G", rgb + 1, 3), add("B", rgb + 2, 3);
  if (!image.alpha.empty()) add("A", image.alpha.data(), 1);
  for (const Channel& channel : channels) add(exr_name(channel.name), channel.values.data(), 1);

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
