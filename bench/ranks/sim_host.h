// What    A rank's transport in the simulation: the network's, with what each message occupies the rank's
//         thread for.
// Units   Seconds.
#pragma once

#include <utility>

#include "kdray/error.h"
#include "transport/simulated.h"

namespace kdray::bench {

struct HostCosts {
  double send = 0, take = 0;  // of a message
  struct OfBytes {
    transport::Tag tag = 0;
    double seconds = 0;  // for a byte of what has this tag, taken
  } take_byte_of = {};
};

class SimHost final : public transport::Transport {
 public:
  SimHost(transport::Network& network, int rank, const HostCosts& costs)
      : Transport(rank, network.ranks()), network_(network), costs_(costs) {}

  std::size_t bytes_waiting() const override { return 0; }
  double now() const override { return network_.free_at(rank()); }
  [[noreturn]] void abort(int) override {
    throw Error(ErrorCode::internal, "a simulated rank has ended all");
  }

 private:
  void post(int to, transport::Tag tag, transport::Bytes bytes) override {
    network_.occupy(rank(), costs_.send);
    network_.rank(rank()).send(to, tag, std::move(bytes));
  }

  std::optional<transport::Message> take() override {
    auto message = network_.rank(rank()).poll();
    if (!message) return message;
    double seconds = costs_.take;
    if (message->tag == costs_.take_byte_of.tag)
      seconds += costs_.take_byte_of.seconds * static_cast<double>(message->bytes.size());
    network_.occupy(rank(), seconds);
    return message;
  }

  transport::Network& network_;
  HostCosts costs_;
};

}  // namespace kdray::bench
