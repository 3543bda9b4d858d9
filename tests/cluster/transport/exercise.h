// What    What any transport has to do: every rank sends every rank (itself, too) messages of many lengths
//         and tags, and gets each of those that are meant for it once, as it was sent.
// Shape   A rank goes on with step() until it says that all has come; whoever drives the ranks decides when
//         each goes on.
#pragma once

#include <map>
#include <random>
#include <stdexcept>
#include <string>

#include "cluster/transport/transport.h"

namespace kdray::test {

class Exercise {
 public:
  Exercise(transport::Transport& transport, int messages) : transport_(transport), messages_(messages) {
    std::mt19937 random(static_cast<std::uint32_t>(transport.rank()));
    for (int i = 0; i < messages; ++i)
      for (int to = 0; to < transport.ranks(); ++to) {
        const std::size_t n = i == 0 ? 0 : i == 1 ? 3 << 20 : random() % 20000;
        transport.send(to, static_cast<transport::Tag>(i), contents(transport.rank(), to, i, n));
      }
  }

  // False: all has come.
  bool step() {
    while (auto message = transport_.poll()) take(*message);
    return static_cast<int>(seen_.size()) < messages_ * transport_.ranks();
  }

 private:
  static transport::Bytes contents(int from, int to, int number, std::size_t n) {
    std::mt19937 random(static_cast<std::uint32_t>((from * 64 + to) * 4096 + number));
    transport::Bytes bytes(n, '\0');
    for (char& c : bytes) c = static_cast<char>(random());
    return bytes;
  }

  void take(const transport::Message& message) {
    const int number = message.tag;
    if (!seen_.emplace(std::pair(message.from, number), true).second)
      throw std::runtime_error("a message came twice");
    if (message.bytes != contents(message.from, transport_.rank(), number, message.bytes.size()) ||
        (number == 0) != message.bytes.empty() || (number == 1) != (message.bytes.size() > 20000))
      throw std::runtime_error("a message came otherwise than it was sent");
  }

  transport::Transport& transport_;
  int messages_;
  std::map<std::pair<int, int>, bool> seen_;
};

}  // namespace kdray::test
