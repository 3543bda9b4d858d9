#include "engine/checkpoint/create_once.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cctype>
#include <cerrno>
#include <cstring>
#include <memory>
#include <random>

#include "base/error.h"
#include "base/temporary.h"

namespace kdray::checkpoint {

namespace fs = std::filesystem;

namespace {

Error cannot_make(const fs::path& file, int error) {
  return input_error(file.string(), 0, fmt::format("can't be made ({})", std::strerror(error)),
                     "name a folder where you may write");
}

// False with errno set.
bool write_new(const fs::path& file, std::string_view content) {
  const int descriptor = ::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (descriptor < 0) return false;
  const bool whole =
      ::write(descriptor, content.data(), content.size()) == static_cast<ssize_t>(content.size());
  const int error = whole ? 0 : errno;
  const bool closed = ::close(descriptor) == 0;  // NFS tells of a full disk here
  if (!whole) errno = error;
  return whole && closed;
}

// A reply that was lost on NFS makes a link that was made look like one that failed: the count tells.
bool is_linked(const fs::path& file) {
  struct stat facts {};
  return ::stat(file.c_str(), &facts) == 0 && facts.st_nlink == 2;
}

}  // namespace

bool create_once(const fs::path& file, std::string_view content) {
  const Temporary own(file.parent_path() / ("." + new_owner()));
  if (!write_new(own.path(), content)) throw cannot_make(file, errno);
  if (::link(own.path().c_str(), file.c_str()) == 0 || is_linked(own.path())) return true;
  if (errno == EEXIST) return false;
  if (errno != EPERM && errno != EOPNOTSUPP && errno != ENOSYS && errno != EMLINK)
    throw cannot_make(file, errno);
  if (write_new(file, content)) return true;
  if (errno == EEXIST) return false;
  throw cannot_make(file, errno);
}

std::string read_small(const fs::path& file, std::size_t most) {
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return {};
  std::string content(most, '\0');
  const ssize_t n = ::read(descriptor, content.data(), most);
  ::close(descriptor);
  content.resize(n > 0 ? static_cast<std::size_t>(n) : 0);
  return content;
}

std::string new_owner() {
  char host[65] = "";
  ::gethostname(host, sizeof host - 1);
  for (char& c : host)
    if (c != '\0' && std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
  return fmt::format("{}-{}-{:08x}", host, ::getpid(), std::random_device()());
}

}  // namespace kdray::checkpoint
