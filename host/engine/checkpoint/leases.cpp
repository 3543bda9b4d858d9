#include "engine/checkpoint/leases.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <memory>
#include <random>
#include <system_error>
#include <utility>

#include "base/error.h"

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

namespace {

constexpr int kBeatsToALease = 5;
constexpr std::size_t kMostDigits = 24;

std::filesystem::path beat_of(const std::filesystem::path& folder, const std::string& owner) {
  return folder / (owner + ".beat");
}

}  // namespace

Heartbeat::Heartbeat(std::filesystem::path folder, std::string owner, double lease_seconds)
    : folder_(std::move(folder)),
      owner_(std::move(owner)),
      lease_(lease_seconds),
      file_(beat_of(folder_, owner_)) {
  beat();  // before anything is claimed
  thread_ = std::jthread([this](const std::stop_token& stop) {
    std::unique_lock lock(mutex_);
    while (!stop.stop_requested()) {
      ends_.wait_for(lock, stop, lease_ / kBeatsToALease, [] { return false; });
      if (!stop.stop_requested()) beat();
    }
  });
}

// The thread first: it would make the file anew.
Heartbeat::~Heartbeat() {
  thread_.request_stop();
  thread_.join();
}

// A beat that can't be written is lost; the lease has several.
void Heartbeat::beat() {
  const int descriptor = ::open(file_.path().c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
  if (descriptor < 0) return;
  const std::string count = std::to_string(++count_);
  (void)!::pwrite(descriptor, count.data(), count.size(), 0);
  ::close(descriptor);  // which is when NFS shows it to others
}

bool Heartbeat::is_alive(const std::string& owner) {
  if (owner == owner_) return true;
  const std::string count = read_small(beat_of(folder_, owner), kMostDigits);
  const auto now = Clock::now();
  const auto [found, is_new] = watched_.try_emplace(owner, Watched{count, now});
  Watched& watched = found->second;
  if (count != watched.count) watched = {count, now};
  // An owner without a name has made its lease a moment ago, or was killed in that moment.
  if (count.empty() && !owner.empty()) return false;
  return now - watched.since <= lease_;
}

namespace fs = std::filesystem;

namespace {

constexpr const char* kDone = "done";
constexpr std::size_t kLongestOwner = 128;

// A number at the text's beginning, which is taken from it; false: there is none.
template <class Number>
bool take_number(std::string_view& text, Number& number) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc()) return false;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return true;
}

}  // namespace

Leases::Leases(fs::path folder, std::string name, std::size_t first, std::size_t n, Heartbeat& heartbeat)
    : folder_(std::move(folder)), name_(std::move(name)), first_(first), heartbeat_(heartbeat), things_(n) {}

fs::path Leases::file_of(std::size_t i, const std::string& ending) const {
  return folder_ / (name_ + "-" + std::to_string(first_ + i) + "." + ending);
}

void Leases::read_name(const std::string& name) {
  std::string_view rest = name;
  std::size_t number = 0;
  if (!rest.starts_with(name_ + "-")) return;
  rest.remove_prefix(name_.size() + 1);
  if (!take_number(rest, number) || number < first_ || number - first_ >= things_.size() ||
      !rest.starts_with('.'))
    return;
  rest.remove_prefix(1);
  Thing& thing = things_[number - first_];
  std::uint32_t lease = 0;
  if (rest == kDone) thing.done = true;
  if (take_number(rest, lease) && rest.empty()) thing.next = std::max(thing.next, lease + 1);
}

// A lease that was taken over is another's, although this process may still be at work.
void Leases::find_owner(std::size_t i, std::map<std::string, bool>& alive) {
  Thing& thing = things_[i];
  thing.held = false;
  if (thing.next == 0 || thing.done) return;
  const std::uint32_t last = thing.next - 1;
  if (thing.owner_of != last || thing.owner.empty())
    thing.owner = read_small(file_of(i, std::to_string(last)), kLongestOwner), thing.owner_of = last;
  thing.mine = thing.owner == heartbeat_.owner();
  const auto [found, is_new] = alive.try_emplace(thing.owner, true);
  if (is_new) found->second = heartbeat_.is_alive(thing.owner);
  thing.held = found->second;
}

void Leases::look() {
  std::error_code error;
  for (fs::directory_iterator entry(folder_, error), end; !error && entry != end; entry.increment(error))
    read_name(entry->path().filename().string());
  std::map<std::string, bool> alive;  // each is asked once
  for (std::size_t i = 0; i < things_.size(); ++i) find_owner(i, alive);
}

std::size_t Leases::n_done() const {
  return static_cast<std::size_t>(std::ranges::count_if(things_, [](const Thing& t) { return t.done; }));
}

bool Leases::claim(std::size_t i) {
  Thing& thing = things_[i];
  const bool got = create_once(file_of(i, std::to_string(thing.next)), heartbeat_.owner());
  thing.held = true;
  thing.mine = got;
  if (got) {
    thing.owner = heartbeat_.owner();
    thing.owner_of = thing.next;
  }
  ++thing.next;
  return got;
}

bool Leases::finish(std::size_t i) {
  things_[i].done = true;
  things_[i].mine = things_[i].held = false;
  return create_once(file_of(i, kDone), heartbeat_.owner());
}

}  // namespace kdray::checkpoint
