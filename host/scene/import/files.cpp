#include "scene/import/files.h"

#include <lzma.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <string>
#include <system_error>
#include <utility>

#include "base/error.h"
#include "base/memory.h"
#include "scene/import/text_scanner.h"

namespace kdray::scene {

namespace {

thread_local FilesRead* recorder = nullptr;

}  // namespace

FilesRead::FilesRead() : outer_(std::exchange(recorder, this)) {}

FilesRead::~FilesRead() {
  recorder = outer_;
}

void FilesRead::add(const std::filesystem::path& path, std::string_view bytes) {
  if (recorder) recorder->files_.push_back({.path = path, .content = hash_of(bytes)});
}

void FilesRead::add_missing(const std::filesystem::path& path) {
  if (recorder) recorder->files_.push_back({.path = path, .content = std::nullopt});
}

void FilesRead::add_named(const std::filesystem::path& scene, std::string_view name) {
  if (!recorder || name.empty()) return;
  std::string slashed(name);
  std::ranges::replace(slashed, '\\', '/');
  const std::filesystem::path path(slashed), folder = scene.parent_path();
  recorder->files_.push_back({.path = folder / path, .content = std::nullopt, .only_named = true});
  if (path.has_parent_path())
    recorder->files_.push_back(
        {.path = folder / path.filename(), .content = std::nullopt, .only_named = true});
}

namespace {

namespace fs = std::filesystem;

thread_local fs::path asset_root;

// Returns the only entry of the folder whose name is this but for capitals; empty where there is none, or
// several.
fs::path entry_like(const fs::path& folder, const std::string& name) {
  std::error_code error;
  fs::path found;
  fs::directory_iterator entry(folder.empty() ? "." : folder, error);
  for (; !error && entry != fs::directory_iterator(); entry.increment(error)) {
    const fs::path there = entry->path().filename();
    if (!same_word(there.string(), name)) continue;
    if (!found.empty()) return {};
    found = folder / there;
  }
  return found;
}

fs::path in_other_capitals(const fs::path& path) {
  std::error_code ignored;
  fs::path at;
  for (const fs::path& part : path) {
    const fs::path exact = at / part;
    at = fs::exists(exact, ignored) ? exact : entry_like(at, part.string());
    if (at.empty()) return {};
  }
  return fs::is_regular_file(at, ignored) ? at : fs::path();
}

bool is_inside(const fs::path& path, const fs::path& folder) {
  std::error_code error;
  const fs::path inner = fs::weakly_canonical(path, error);
  if (error) return false;
  const fs::path outer = fs::canonical(folder, error);
  if (error) return false;
  return std::mismatch(outer.begin(), outer.end(), inner.begin(), inner.end()).first == outer.end();
}

}  // namespace

std::string slashed(std::string_view name) {
  std::string out(name);
  std::ranges::replace(out, '\\', '/');
  return out;
}

std::string_view unquoted(std::string_view name) {
  const bool quoted =
      name.size() > 2 && (name.front() == '"' || name.front() == '\'') && name.back() == name.front();
  return quoted ? name.substr(1, name.size() - 2) : name;
}

fs::path find_file(const fs::path& path) {
  std::error_code ignored;
  if (fs::is_regular_file(path, ignored)) return path;
  FilesRead::add_missing(path);
  return in_other_capitals(path);
}

bool may_name(const fs::path& folder, const fs::path& name) {
  const fs::path normal = name.lexically_normal();
  if (!normal.empty() && !normal.has_root_path() && *normal.begin() != "..") return true;
  if (asset_root.empty()) return false;
  // Where there is a file, it counts itself: its name may be a link, or differ in capitals.
  const fs::path path = folder / name, other = in_other_capitals(path);
  return is_inside(other.empty() ? path : other, asset_root);
}

std::string outside(std::string_view name) {
  return "'" + printable(name) + "' is not a file beside the scene, or below";
}

AssetRoot::AssetRoot(fs::path folder) : outer_(std::exchange(asset_root, std::move(folder))) {}

AssetRoot::~AssetRoot() {
  asset_root = std::move(outer_);
}

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

// Refuses what servers and version control give in place of a file, under its name.
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
    throw input_error(file, 0, "is a folder", "name a file in it");
  }
  const std::unique_ptr<std::FILE, Close> in(std::fopen(file.c_str(), "rb"));
  if (!in) throw input_error(file, 0, std::string("cannot be read: ") + std::strerror(errno));
  Output out(file, max_bytes);
  // Where the size is known (a regular file), it is read straight into the result, so that a big mesh is not
  // copied.
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
