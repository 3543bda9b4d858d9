#include "accel/cache/mapped_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

namespace kdray::cache {

namespace {

std::optional<MappedFile> map(int descriptor) {
  struct stat status {};
  if (::fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode)) return std::nullopt;
  const auto size = static_cast<std::size_t>(status.st_size);
  if (size == 0) return MappedFile{};  // mmap refuses to map nothing
  void* const memory = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, descriptor, 0);
  if (memory == MAP_FAILED) return std::nullopt;
  return MappedFile{{memory, [size](void* p) { ::munmap(p, size); }}, size};
}

}  // namespace

std::optional<MappedFile> map_file(const std::filesystem::path& file) {
  // O_NONBLOCK: the file may be a pipe, whose other end would be waited for.
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) return std::nullopt;
  std::optional<MappedFile> mapped = map(descriptor);
  ::close(descriptor);
  return mapped;
}

}  // namespace kdray::cache
