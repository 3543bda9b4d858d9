#include "engine/checkpoint/heartbeat.h"

#include <fcntl.h>
#include <unistd.h>

#include <utility>

#include "engine/checkpoint/create_once.h"

namespace kdray::checkpoint {

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

}  // namespace kdray::checkpoint
