// What    What kdray needs of a network: ranks, numbered from 0, that send each other messages.
// Shape   Messages are whole and come once, in any order: even those of one rank may overtake each other. A
//         rank may send to itself. send() takes the bytes over and doesn't wait for the receiver; poll()
//         returns a message that has come, and moves on what is still to be sent. So a rank that has sent
//         something goes on polling until all ranks close().
// Units   Bytes; seconds.
// Errors  kdray::Error, ErrorCode::internal: the network failed, a message came that is none of kdray's, or a
//         message is too long to be sent.
// Threads One at a time may call. MPI's implementation is for one thread alone, though not necessarily the
//         one that opened it.
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

  // Returns how many of the bytes that were sent have not left yet.
  virtual std::size_t bytes_waiting() const = 0;

  // Returns the seconds since some moment, by this rank's clock; in a simulation they are virtual.
  virtual double now() const = 0;

  // Ends the use of the network. All ranks have to call it, when nothing that they need is on its way;
  // nothing may be called after it.
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
