#include "base/nameless_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <string>

namespace kdray {

namespace {

// Not every file system knows files that never had a name; there one is removed at once.
int open_nameless(const std::filesystem::path& folder) {
  const int file = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (file >= 0 || errno == ENOENT || errno == EACCES || errno == ENOTDIR) return file;
  std::string name = (folder / "kdray-XXXXXX").string();
  const int named = ::mkostemp(name.data(), O_CLOEXEC);
  if (named >= 0) ::unlink(name.c_str());
  return named;
}

void* map_space(int file, std::size_t bytes) {
  if (const int error = ::posix_fallocate(file, 0, static_cast<off_t>(bytes)); error != 0) {
    errno = error;
    return nullptr;
  }
  void* const memory = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
  return memory == MAP_FAILED ? nullptr : memory;
}

}  // namespace

std::shared_ptr<void> map_nameless_file(const std::filesystem::path& folder, std::size_t bytes) {
  const int file = open_nameless(folder);
  if (file < 0) return nullptr;
  void* const memory = map_space(file, bytes);
  const int error = errno;
  ::close(file);
  errno = error;
  if (memory == nullptr) return nullptr;
  return {memory, [bytes](void* p) { ::munmap(p, bytes); }};
}

}  // namespace kdray
