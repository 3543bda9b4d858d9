#include "cluster/transport/delayed.h"

#include <algorithm>
#include <cstdlib>
#include <map>
#include <random>
#include <utility>

namespace kdray::transport {

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
