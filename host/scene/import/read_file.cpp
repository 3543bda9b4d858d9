#include "scene/import/read_file.h"

#include <lzma.h>
#include <zlib.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <system_error>

#include "base/error.h"
#include "base/memory.h"
#include "scene/import/files_read.h"
#include "scene/import/lower.h"

namespace kdray::scene {

namespace {

constexpr std::size_t kChunk = std::size_t{1} << 18;
// The window an .xz file may ask for before its first byte is unpacked; `xz -9` needs 65 MiB.
constexpr std::uint64_t kXzMemory = std::uint64_t{256} << 20;

std::string ending_of(const std::filesystem::path& file) {
  return lower(file.extension().string());
}

Error damaged(const std::string& file, const std::string& how) {
  return input_error(file, 0, "damaged: " + how, "fetch or pack it again");
}

// What servers and version control give in place of a file, under its name.
void refuse_stand_in(std::string_view bytes, const std::string& file) {
  constexpr std::size_t kFirst = 256;  // bytes: what is there is told by the first of them
  std::string start = lower(bytes.substr(0, kFirst));
  if (start.starts_with("version https://git-lfs"))
    throw input_error(file, 0, "is a Git LFS pointer, not the file that it stands for",
                      "run 'git lfs pull' where it comes from, or download the file itself");
  start.erase(0, std::min(start.find_first_not_of(" \t\r\n\xef\xbb\xbf"), start.size()));
  if (start.starts_with("<!doctype html") || start.starts_with("<html"))
    throw input_error(file, 0, "is a web page (HTML), not the file that its name says",
                      "download the file itself, not the page that shows it");
}

// Bytes as they come out of a decompressor. std::string grows geometrically, so the copies stay linear in the
// size, and memory is only taken for bytes that are really there.
class Output {
 public:
  Output(std::string file, std::size_t max_bytes) : file_(std::move(file)), max_bytes_(max_bytes) {}

  void append(const char* bytes, std::size_t n) {
    if (n > max_bytes_ - text_.size()) {
      throw input_error(file_, 0, "larger than " + std::to_string(max_bytes_) + " bytes unpacked",
                        "split the scene into several files");
    }
    text_.append(bytes, n);
  }
  std::string take() { return std::move(text_); }

 private:
  std::string file_;
  std::size_t max_bytes_;
  std::string text_;
};

struct Close {
  void operator()(std::FILE* f) const { std::fclose(f); }
};

std::string read_bytes(const std::filesystem::path& path, std::size_t max_bytes) {
  const std::string file = path.string();
  std::error_code code;
  const auto status = std::filesystem::status(path, code);
  if (status.type() == std::filesystem::file_type::not_found) {
    throw input_error(file, 0, "no such file", "check the path");
  }
  if (status.type() == std::filesystem::file_type::directory) {
    throw input_error(file, 0, "is a folder", "name a scene file in it");
  }
  const std::unique_ptr<std::FILE, Close> in(std::fopen(file.c_str(), "rb"));
  if (!in) throw input_error(file, 0, std::string("cannot be read: ") + std::strerror(errno));
  Output out(file, max_bytes);
  // Straight into the result where the size is known (a regular file), so that a big mesh is not copied.
  std::string text;
  const std::uintmax_t size = std::filesystem::file_size(path, code);
  if (!code && size <= max_bytes) {
    text.reserve(static_cast<std::size_t>(size));
    prefer_large_pages(text.data(), text.capacity());
    text.resize(static_cast<std::size_t>(size));
    text.resize(std::fread(text.data(), 1, text.size(), in.get()));
  }
  const auto buffer = std::make_unique<char[]>(kChunk);
  bool first = true;
  while (const std::size_t n = std::fread(buffer.get(), 1, kChunk, in.get())) {
    if (first) out.append(text.data(), text.size());
    first = false;
    out.append(buffer.get(), n);
  }
  if (std::ferror(in.get()))
    throw input_error(file, 0, std::string("cannot be read: ") + std::strerror(errno));
  return first ? text : out.take();
}

// gzip files may hold several members one after the other; zeros may pad the end.
std::string gunzip(const std::string& packed, const std::string& file, std::size_t max_bytes) {
  z_stream stream{};
  constexpr int kGzipOnly = 16 + MAX_WBITS;
  if (inflateInit2(&stream, kGzipOnly) != Z_OK) throw Error(ErrorCode::internal, "zlib does not start");
  const std::unique_ptr<z_stream, int (*)(z_stream*)> end(&stream, inflateEnd);
  const auto buffer = std::make_unique<char[]>(kChunk);
  Output out(file, max_bytes);
  std::size_t at = 0;
  bool done = false;
  while (!done) {
    if (stream.avail_in == 0) {
      const std::size_t n = std::min(kChunk, packed.size() - at);
      stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data() + at));
      stream.avail_in = static_cast<uInt>(n);
      at += n;
    }
    stream.next_out = reinterpret_cast<Bytef*>(buffer.get());
    stream.avail_out = static_cast<uInt>(kChunk);
    const int code = inflate(&stream, Z_NO_FLUSH);
    out.append(buffer.get(), kChunk - stream.avail_out);
    if (code == Z_STREAM_END) {
      at -= stream.avail_in;
      stream.avail_in = 0;
      const std::size_t next = packed.find_first_not_of('\0', at);
      done = next == std::string::npos;
      if (!done) at = next, inflateReset(&stream);
    } else if (code == Z_BUF_ERROR && stream.avail_in == 0 && at == packed.size()) {
      throw damaged(file, "the gzip data end too soon");
    } else if (code != Z_OK && code != Z_BUF_ERROR) {
      throw damaged(file, std::string("not gzip data: ") + (stream.msg ? stream.msg : "unknown header"));
    }
  }
  return out.take();
}

const char* xz_fault(lzma_ret code) {
  switch (code) {
    case LZMA_BUF_ERROR:
      return "the xz data end too soon";
    case LZMA_FORMAT_ERROR:
      return "not xz data";
    case LZMA_OPTIONS_ERROR:
      return "xz options this build cannot unpack";
    default:
      return "the xz data are corrupt";
  }
}

std::string unxz(const std::string& packed, const std::string& file, std::size_t max_bytes) {
  lzma_stream stream = LZMA_STREAM_INIT;
  if (lzma_stream_decoder(&stream, kXzMemory, LZMA_CONCATENATED) != LZMA_OK) {
    throw Error(ErrorCode::internal, "liblzma does not start");
  }
  const std::unique_ptr<lzma_stream, void (*)(lzma_stream*)> end(&stream, lzma_end);
  const auto buffer = std::make_unique<char[]>(kChunk);
  Output out(file, max_bytes);
  stream.next_in = reinterpret_cast<const std::uint8_t*>(packed.data());
  stream.avail_in = packed.size();
  lzma_ret code = LZMA_OK;
  while (code == LZMA_OK) {
    stream.next_out = reinterpret_cast<std::uint8_t*>(buffer.get());
    stream.avail_out = kChunk;
    code = lzma_code(&stream, LZMA_FINISH);
    out.append(buffer.get(), kChunk - stream.avail_out);
  }
  if (code == LZMA_MEMLIMIT_ERROR) {
    throw input_error(file, 0, "its xz data need more than 256 MiB of memory to unpack",
                      "pack it with xz -9 or less");
  }
  if (code != LZMA_STREAM_END) throw damaged(file, xz_fault(code));
  return out.take();
}

}  // namespace

std::string read_file(const std::filesystem::path& file, std::size_t max_bytes) {
  std::string bytes = read_bytes(file, max_bytes);
  FilesRead::add(file, bytes);
  return unpacked(std::move(bytes), file, max_bytes);
}

std::string unpacked(std::string bytes, const std::filesystem::path& file, std::size_t max_bytes) {
  refuse_stand_in(bytes, file.string());
  const std::string ending = ending_of(file);
  if (ending != ".gz" && ending != ".xz") return bytes;
  std::string all =
      ending == ".gz" ? gunzip(bytes, file.string(), max_bytes) : unxz(bytes, file.string(), max_bytes);
  refuse_stand_in(all, file.string());
  return all;
}

std::string format_of(const std::filesystem::path& file) {
  const std::string ending = ending_of(file);
  if (ending == ".gz" || ending == ".xz") return ending_of(file.stem());
  return ending;
}

}  // namespace kdray::scene
