#include "cluster/transport/together.h"

#include <fmt/format.h>

namespace kdray::transport {

namespace {

constexpr Tag kStep = kTagsOfShares.first;

}  // namespace

void throw_odd_message(int from) {
  throw Error(ErrorCode::internal, fmt::format("rank {} is at another step than this rank", from));
}

// Sends the step's number behind the bytes, so that they need not be moved.
void Together::send(int to, std::uint32_t step, Bytes bytes) {
  bytes.append(reinterpret_cast<const char*>(&step), sizeof step);
  ranks_.send(to, kStep, std::move(bytes));
}

Bytes Together::receive(int from, std::uint32_t step) {
  for (;;) {
    if (auto found = early_.extract({step, from}); !found.empty()) return std::move(found.mapped());
    Message message = ranks_.wait(kTagsOfShares);
    std::uint32_t sent = 0;
    if (message.bytes.size() < sizeof sent) throw_odd_message(message.from);
    std::memcpy(&sent, message.bytes.data() + message.bytes.size() - sizeof sent, sizeof sent);
    message.bytes.resize(message.bytes.size() - sizeof sent);
    // What a step before this one has left over would never be asked for.
    if (sent < step || !early_.emplace(std::pair(sent, message.from), std::move(message.bytes)).second)
      throw_odd_message(message.from);
  }
}

std::vector<Bytes> Together::exchange(std::vector<Bytes> out) {
  const std::uint32_t step = begin();
  for (int to = 0; to < size(); ++to)
    if (to != rank()) send(to, step, std::move(out[static_cast<std::size_t>(to)]));
  std::vector<Bytes> in(out.size());
  for (int from = 0; from < size(); ++from) {
    const auto i = static_cast<std::size_t>(from);
    in[i] = from == rank() ? std::move(out[i]) : receive(from, step);
  }
  return in;
}

std::vector<Bytes> Together::gather(Bytes own) {
  std::vector<Bytes> out(static_cast<std::size_t>(size()), own);
  return exchange(std::move(out));
}

}  // namespace kdray::transport
