#include "cluster/transport/simulated.h"

#include <algorithm>
#include <cstdlib>
#include <deque>
#include <map>
#include <mutex>
#include <stdexcept>
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

class Simulated final : public Transport {
 public:
  Simulated(int rank, int ranks, Network& network) : Transport(rank, ranks), network_(network) {}

  std::size_t bytes_waiting() const override { return 0; }
  double now() const override { return network_.now(); }
  [[noreturn]] void abort(int) override { throw std::runtime_error("a simulated rank has ended all"); }

 private:
  void post(int to, Tag tag, Bytes bytes) override { network_.post(rank(), to, tag, std::move(bytes)); }

  std::optional<Message> take() override {
    std::queue<Message>& inbox = network_.inboxes_[static_cast<std::size_t>(rank())];
    if (inbox.empty()) return std::nullopt;
    Message message = std::move(inbox.front());
    inbox.pop();
    return message;
  }

  Network& network_;
};

Network::Network(int ranks, const Link& link, std::uint64_t seed)
    : link_(link),
      random_(seed),
      free_at_(static_cast<std::size_t>(ranks)),
      inboxes_(static_cast<std::size_t>(ranks)) {
  for (int rank = 0; rank < ranks; ++rank) ranks_.push_back(std::make_unique<Simulated>(rank, ranks, *this));
}

void Network::post(int from, int to, Tag tag, Bytes bytes) {
  double& free_at = free_at_[static_cast<std::size_t>(from)];
  free_at = std::max(free_at, now_) + static_cast<double>(bytes.size()) / link_.bandwidth;
  // The generator's bits are the same everywhere; a distribution of the library's need not be.
  const double part = static_cast<double>(random_() >> 11) * 0x1p-53;
  const double travels = to == from ? 0 : link_.latency * (1 + link_.jitter * part);
  on_their_way_.push(
      {free_at + travels, n_posted_++, to, std::make_shared<Message>(Message{from, tag, std::move(bytes)})});
}

double Network::next_arrival() const {
  return on_their_way_.empty() ? std::numeric_limits<double>::infinity() : on_their_way_.top().arrives;
}

void Network::advance(double to) {
  now_ = std::max(now_, to);
  for (; !on_their_way_.empty() && on_their_way_.top().arrives <= now_; on_their_way_.pop()) {
    const OnItsWay& next = on_their_way_.top();
    inboxes_[static_cast<std::size_t>(next.to)].push(std::move(*next.message));
  }
}

namespace {

class Delayed final : public Transport {
 public:
  Delayed(std::unique_ptr<Transport> transport, const Link& link, std::uint64_t seed)
      : Transport(transport->rank(), transport->ranks()),
        transport_(std::move(transport)),
        link_(link),
        random_(seed) {}

  std::size_t bytes_waiting() const override { return transport_->bytes_waiting(); }
  double now() const override { return transport_->now(); }
  void close() override { transport_->close(); }
  [[noreturn]] void abort(int exit_code) override {
    transport_->abort(exit_code);
    std::abort();
  }

 private:
  void post(int to, Tag tag, Bytes bytes) override { transport_->send(to, tag, std::move(bytes)); }

  std::optional<Message> take() override {
    while (std::optional<Message> message = transport_->poll()) {
      free_at_ = std::max(free_at_, now()) + static_cast<double>(message->bytes.size()) / link_.bandwidth;
      const double more = std::uniform_real_distribution(0.0, 1.0)(random_) * link_.jitter;
      held_.emplace(free_at_ + link_.latency * (1 + more), std::move(*message));
    }
    if (held_.empty() || held_.begin()->first > now()) return std::nullopt;
    return std::move(held_.extract(held_.begin()).mapped());
  }

  std::unique_ptr<Transport> transport_;
  Link link_;
  double free_at_ = 0;
  std::mt19937_64 random_;
  std::multimap<double, Message> held_;  // until when
};

}  // namespace

std::unique_ptr<Transport> delayed(std::unique_ptr<Transport> transport, const Link& link,
                                   std::uint64_t seed) {
  return std::make_unique<Delayed>(std::move(transport), link, seed);
}

}  // namespace kdray::transport
