#include "transport/delayed.h"

#include <algorithm>
#include <cstdlib>
#include <deque>
#include <utility>

namespace kdray::transport {

namespace {

class Delayed final : public Transport {
 public:
  Delayed(std::unique_ptr<Transport> transport, const Link& link)
      : Transport(transport->rank(), transport->ranks()), transport_(std::move(transport)), link_(link) {}

  std::size_t bytes_waiting() const override { return transport_->bytes_waiting(); }
  double now() const override { return transport_->now(); }
  void close() override { transport_->close(); }
  [[noreturn]] void abort(int exit_code) override {
    transport_->abort(exit_code);
    std::abort();
  }

 private:
  struct Held {
    double until;
    Message message;
  };

  void post(int to, Tag tag, Bytes bytes) override { transport_->send(to, tag, std::move(bytes)); }

  std::optional<Message> take() override {
    while (std::optional<Message> message = transport_->poll()) {
      free_at_ = std::max(free_at_, now()) + static_cast<double>(message->bytes.size()) / link_.bandwidth;
      held_.push_back({free_at_ + link_.latency, std::move(*message)});
    }
    if (held_.empty() || held_.front().until > now()) return std::nullopt;
    Message message = std::move(held_.front().message);
    held_.pop_front();
    return message;
  }

  std::unique_ptr<Transport> transport_;
  Link link_;
  double free_at_ = 0;
  std::deque<Held> held_;
};

}  // namespace

std::unique_ptr<Transport> delayed(std::unique_ptr<Transport> transport, const Link& link) {
  return std::make_unique<Delayed>(std::move(transport), link);
}

}  // namespace kdray::transport
