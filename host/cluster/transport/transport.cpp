#include "cluster/transport/transport.h"

#include <fmt/format.h>

#include "base/error.h"
#include "cluster/transport/message_bytes.h"

namespace kdray::transport {

void Transport::send(int to, Tag tag, Bytes bytes) {
  if (to < 0 || to >= ranks_ || tag > kMostTag || bytes.size() > kMostBytes)
    throw Error(ErrorCode::internal, fmt::format("rank {} was to send {} bytes with tag {} to rank {} of {}",
                                                 rank_, bytes.size(), tag, to, ranks_));
  ++counters_.sent;
  counters_.bytes_sent += bytes.size();
  post(to, tag, std::move(bytes));
}

std::optional<Message> Transport::poll() {
  std::optional<Message> message = take();
  if (!message) return message;
  if (message->from < 0 || message->from >= ranks_ || message->tag > kMostTag)
    throw Error(ErrorCode::internal, fmt::format("rank {} got a message with tag {} from rank {} of {}",
                                                 rank_, message->tag, message->from, ranks_));
  ++counters_.received;
  counters_.bytes_received += message->bytes.size();
  return message;
}

void refuse(const Message& message) {
  throw Error(ErrorCode::internal, fmt::format("rank {} sent {} bytes with tag {}, which mean nothing here",
                                               message.from, message.bytes.size(), message.tag));
}

}  // namespace kdray::transport
