#include "base/write_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <random>

#include "base/error.h"
#include "base/temporary.h"

namespace kdray {
namespace fs = std::filesystem;
namespace {

Error cannot_write(const fs::path& file, int error, const fs::path& folder) {
  const std::string where = "'" + folder.string() + "'";
  switch (error) {
    case ENOENT:
      return input_error(file.string(), 0, "the folder " + where + " does not exist",
                         "make it (mkdir -p) or name another place");
    case ENOTDIR:
      return input_error(file.string(), 0, where + " is not a folder", "name another place");
    case EACCES:
    case EPERM:
      return input_error(file.string(), 0, "no permission to write in the folder " + where,
                         "name a place where you may write");
    case EROFS:
      return input_error(file.string(), 0, "the folder " + where + " is on a read-only file system",
                         "name another place");
    case ENOSPC:
    case EDQUOT:
      return input_error(file.string(), 0, "the disk is full", "free some space or name another place");
    case EFBIG:
      return input_error(file.string(), 0, "the file gets larger than the system allows",
                         "raise the limit (ulimit -f) or name a place on another file system");
    case ENAMETOOLONG:
      return input_error(file.string(), 0, "the file name is too long", "choose a shorter one");
    default:
      return input_error(file.string(), 0, std::string("cannot be written: ") + std::strerror(error));
  }
}

fs::path folder_of(const fs::path& file) {
  const fs::path parent = file.parent_path();
  return parent.empty() ? fs::path(".") : parent;
}

// An existing target must be a file that its owner left writable: a rename would not check that.
void check_target(const fs::path& file, const fs::path& target, const fs::file_status& status) {
  if (target.filename().empty() || fs::is_directory(status))
    throw input_error(file.string(), 0, "is a folder", "name a file in it");
  if (fs::exists(status) && ::access(target.c_str(), W_OK) != 0)
    throw input_error(file.string(), 0, "exists and is write-protected", "remove it or name another file");
}

bool is_special(const fs::file_status& status) {
  return fs::exists(status) && !fs::is_regular_file(status);
}

// Creates an empty file of a new name beside `target`, with the permissions that the umask leaves.
std::unique_ptr<Temporary> create_beside(const fs::path& file, const fs::path& target) {
  const fs::path folder = folder_of(target);
  std::random_device random;
  for (int attempt = 0; attempt < 100; ++attempt) {
    char name[48];
    std::snprintf(name, sizeof name, ".kdray-%d-%08x", static_cast<int>(::getpid()), random());
    auto temporary = std::make_unique<Temporary>(folder / (name + target.extension().string()));
    const int descriptor = ::open(temporary->path().c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor >= 0) {
      ::close(descriptor);
      return temporary;
    }
    const int error = errno;
    temporary->forget();
    if (error != EEXIST) throw cannot_write(file, error, folder);
  }
  throw cannot_write(file, EEXIST, folder);
}

}  // namespace

fs::path where_written(fs::path file) {
  std::error_code error;
  for (int n_links = 0; n_links < 40 && fs::is_symlink(file, error); ++n_links) {
    const fs::path to = fs::read_symlink(file, error);
    if (error) break;
    file = to.is_absolute() ? to : folder_of(file) / to;
  }
  return file;
}

void write_atomically(const fs::path& file, const std::function<void(const fs::path&)>& write) {
  std::error_code error;
  const fs::path target = where_written(file);
  const fs::file_status status = fs::status(target, error);
  check_target(file, target, status);
  if (is_special(status)) return write(target);
  const std::unique_ptr<Temporary> temporary = create_beside(file, target);
  write(temporary->path());
  if (fs::exists(status)) fs::permissions(temporary->path(), status.permissions(), error);
  if (std::rename(temporary->path().c_str(), target.c_str()) != 0)
    throw cannot_write(file, errno, folder_of(target));
  temporary->forget();
}

void write_pieces(const fs::path& temporary, const fs::path& shown,
                  const std::function<void(const Sink&)>& produce) {
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> stream(std::fopen(temporary.c_str(), "ab"), std::fclose);
  if (!stream) throw cannot_write(shown, errno, folder_of(shown));
  produce([&](std::string_view piece) {
    // fwrite wants a pointer even for nothing.
    if (!piece.empty() && std::fwrite(piece.data(), 1, piece.size(), stream.get()) != piece.size())
      throw cannot_write(shown, errno, folder_of(shown));
  });
  // A full disk may show only when the buffer is flushed.
  if (std::fclose(stream.release()) != 0) throw cannot_write(shown, errno, folder_of(shown));
}

void write_bytes(const fs::path& temporary, const fs::path& shown, std::string_view content) {
  write_pieces(temporary, shown, [&](const Sink& sink) { sink(content); });
}

void write_file(const fs::path& file, std::string_view content) {
  write_atomically(file, [&](const fs::path& temporary) { write_bytes(temporary, file, content); });
}

void check_writable(const fs::path& file) {
  std::error_code error;
  const fs::path target = where_written(file);
  const fs::file_status status = fs::status(target, error);
  check_target(file, target, status);
  if (!is_special(status)) create_beside(file, target);  // and removes it at once
}

}  // namespace kdray
