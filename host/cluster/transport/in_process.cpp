#include "cluster/transport/in_process.h"

#include <cstdlib>
#include <deque>
#include <mutex>
#include <utility>

#include "base/timer.h"

namespace kdray::transport {

namespace {

struct Inbox {
  std::mutex mutex;
  std::deque<Message> messages;
};

class InProcess final : public Transport {
 public:
  InProcess(int rank, std::shared_ptr<std::vector<Inbox>> inboxes)
      : Transport(rank, static_cast<int>(inboxes->size())), inboxes_(std::move(inboxes)) {}

  std::size_t bytes_waiting() const override { return 0; }
  double now() const override { return clock_.seconds(); }
  [[noreturn]] void abort(int exit_code) override { std::_Exit(exit_code); }

 private:
  void post(int to, Tag tag, Bytes bytes) override {
    Inbox& inbox = (*inboxes_)[static_cast<std::size_t>(to)];
    const std::lock_guard lock(inbox.mutex);
    inbox.messages.push_back({rank(), tag, std::move(bytes)});
  }

  std::optional<Message> take() override {
    Inbox& inbox = (*inboxes_)[static_cast<std::size_t>(rank())];
    const std::lock_guard lock(inbox.mutex);
    if (inbox.messages.empty()) return std::nullopt;
    Message message = std::move(inbox.messages.front());
    inbox.messages.pop_front();
    return message;
  }

  std::shared_ptr<std::vector<Inbox>> inboxes_;
  Timer clock_;
};

}  // namespace

std::vector<std::unique_ptr<Transport>> in_process(int ranks) {
  const auto inboxes = std::make_shared<std::vector<Inbox>>(static_cast<std::size_t>(ranks));
  std::vector<std::unique_ptr<Transport>> all;
  for (int rank = 0; rank < ranks; ++rank) all.push_back(std::make_unique<InProcess>(rank, inboxes));
  return all;
}

}  // namespace kdray::transport
