// What    What kdray needs of a network: ranks, numbered from 0, that send each other messages.
// Shape   Messages are whole and come once, in any order: also those of one rank may overtake each other. A
//         rank may send to itself. send() takes the bytes over and doesn't wait for the receiver; poll()
//         hands what has come over to the caller, and moves on what is still to be sent. So whoever has sent
//         something goes on polling: all have when they close().
// Units   Bytes; seconds.
// Errors  kdray::Error, ErrorCode::internal: the network failed, a message that is none of kdray's came, or
//         one was to be sent that is too long.
// Threads One at a time may call. MPI's implementation is for one thread alone, which need not be the one
//         that opened it.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

namespace kdray::transport {

using Tag = std::uint16_t;
using Bytes = std::string;  // any bytes

inline constexpr Tag kMostTag = 0x3fff;  // MPI promises 32767
inline constexpr std::size_t kMostBytes = std::size_t{1} << 30;

struct Message {
  int from = 0;
  Tag tag = 0;
  Bytes bytes = {};
};

struct Counters {
  std::uint64_t sent = 0, received = 0;  // messages
  std::uint64_t bytes_sent = 0, bytes_received = 0;
};

class Transport {
 public:
  virtual ~Transport() = default;

  int rank() const { return rank_; }
  int ranks() const { return ranks_; }

  void send(int to, Tag tag, Bytes bytes);
  std::optional<Message> poll();

  // What was sent and isn't gone yet.
  virtual std::size_t bytes_waiting() const = 0;

  // Since some moment, of this rank's clock; in the simulation virtual ones.
  virtual double now() const = 0;

  // All ranks have to call it, when nothing they need is on its way. Nothing may be called after it.
  virtual void close() {}

  // Ends all ranks at once, as far as that can be done.
  [[noreturn]] virtual void abort(int exit_code) = 0;

  const Counters& counters() const { return counters_; }

 protected:
  Transport(int rank, int ranks) : rank_(rank), ranks_(ranks) {}

 private:
  virtual void post(int to, Tag tag, Bytes bytes) = 0;
  virtual std::optional<Message> take() = 0;

  int rank_, ranks_;
  Counters counters_;
};

}  // namespace kdray::transport
