#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <string>

#include "base/error.h"
#include "rays/npy.h"
#include "rays/npy_header.h"

namespace kdray::rays {
namespace fs = std::filesystem;
namespace {

static_assert(std::endian::native == std::endian::little, "NumPy's '<f4' is read as it lies");
static_assert(sizeof(Ray) == 8 * sizeof(float), "a row of the array is a Ray");

// The remedies are the Python that a user would type.
void check_type(const NpyHeader& header, const std::string& file) {
  if (header.structured)
    throw input_error(file, 0,
                      "holds records " + header.type.substr(0, 80) + " but rays are plain float32, N x 8",
                      "numpy.lib.recfunctions.structured_to_unstructured(rays, dtype='<f4') makes them so");
  if (header.type != "<f4")
    throw input_error(file, 0,
                      "holds the type '" + header.type.substr(0, 40) + "' but rays are float32 ('<f4')",
                      "save rays.astype('<f4')");
}

std::string shape_text(const NpyHeader& header) {
  std::string text = "(";
  for (std::size_t i = 0; i < header.shape.size() && i < 6; ++i)
    text += (i ? ", " : "") + std::to_string(header.shape[i]);
  return text + (header.shape.size() > 6 ? ", ...)" : header.shape.size() == 1 ? ",)" : ")");
}

std::uint64_t check_shape(const NpyHeader& header, const std::string& file) {
  if (header.shape.size() != 2 || header.shape[1] != 8)
    throw input_error(file, 0, "has the shape " + shape_text(header) + " but rays are N x 8",
                      "columns are origin x y z, t_min, direction x y z, t_max");
  // Rows of one ray, or none, lie the same way in both orders.
  if (header.fortran_order && header.shape[0] > 1)
    throw input_error(file, 0, "is in Fortran order (column by column)",
                      "save numpy.ascontiguousarray(rays)");
  return header.shape[0];
}

class InputFile {
 public:
  explicit InputFile(const fs::path& path) : name_(path.string()), stream_(nullptr, std::fclose) {
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    if (fs::is_directory(status)) throw input_error(name_, 0, "is a folder", "name a .npy file in it");
    if (fs::exists(status) && !fs::is_regular_file(status))
      throw input_error(name_, 0, "is no regular file", "save the rays to a file first");
    stream_.reset(std::fopen(path.c_str(), "rb"));
    if (!stream_)
      throw input_error(name_, 0, std::string("cannot be opened: ") + std::strerror(errno), "check its name");
    size_ = fs::file_size(path, error);
    if (error) throw input_error(name_, 0, "cannot be read: " + error.message());
    // The rays go straight into their vector; a buffer between would only copy them.
    std::setvbuf(stream_.get(), nullptr, _IONBF, 0);
  }

  std::uint64_t size() const { return size_; }

  void seek(std::uint64_t position) {
    if (std::fseek(stream_.get(), static_cast<long>(position), SEEK_SET) != 0) cut_short();
  }
  void read(void* to, std::size_t n_bytes) {
    if (n_bytes > 0 && std::fread(to, 1, n_bytes, stream_.get()) != n_bytes) cut_short();
  }

 private:
  [[noreturn]] void cut_short() const {
    throw input_error(name_, 0, "cannot be read to its end", "check the disk, or save it again");
  }

  std::string name_;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> stream_;
  std::uint64_t size_ = 0;
};

}  // namespace

std::vector<Ray> read_rays(const fs::path& path) {
  const std::string file = path.string();
  InputFile input(path);
  std::string start(static_cast<std::size_t>(std::min<std::uint64_t>(kPreambleBytes, input.size())), '\0');
  input.read(start.data(), start.size());
  const NpyPreamble preamble = parse_preamble(start, file);
  const std::uint64_t data_begin = std::uint64_t{preamble.bytes} + preamble.header_bytes;
  if (data_begin > input.size()) throw input_error(file, 0, "is cut short in its header", "save it again");
  std::string text(preamble.header_bytes, '\0');
  input.seek(preamble.bytes);
  input.read(text.data(), text.size());
  const NpyHeader header = parse_header(text, file);
  check_type(header, file);
  const std::uint64_t n_rays = check_shape(header, file);

  const std::uint64_t data_bytes = input.size() - data_begin;
  if (n_rays != data_bytes / sizeof(Ray) || data_bytes % sizeof(Ray) != 0)
    throw input_error(
        file, 0,
        "has " + std::to_string(data_bytes) + " bytes of data but " + std::to_string(n_rays) +
            " rays of 32 bytes are announced",
        n_rays > data_bytes / sizeof(Ray) ? "it was cut short: save it again" : "save one array to a file");
  std::vector<Ray> rays(static_cast<std::size_t>(n_rays));
  input.read(rays.data(), rays.size() * sizeof(Ray));
  return rays;
}

}  // namespace kdray::rays
