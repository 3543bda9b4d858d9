#include "cluster/transport/ranks.h"

#include <fmt/format.h>

#include <chrono>
#include <cstring>
#include <thread>
#include <utility>

namespace kdray::transport {

namespace {

constexpr Tag kFailed = 0, kEnd = 1, kGone = 2;
constexpr auto kNap = std::chrono::milliseconds(1);
// For ranks to end in order after a failure; one may be in the middle of a scene that it reads.
constexpr double kPatience = 5;  // seconds

Bytes bytes_of(int code, std::string_view text = {}) {
  Bytes bytes(sizeof code, '\0');
  std::memcpy(bytes.data(), &code, sizeof code);
  return bytes.append(text);
}

int code_of(const Message& message) {
  int code = 0;
  if (message.bytes.size() < sizeof code)
    throw Error(ErrorCode::internal, fmt::format("rank {} sent half a message", message.from));
  std::memcpy(&code, message.bytes.data(), sizeof code);
  return code;
}

bool is_code(int code) {
  return code >= static_cast<int>(ErrorCode::input) && code <= static_cast<int>(ErrorCode::cancelled);
}

}  // namespace

void Ranks::send_to_others(Tag tag, const Bytes& bytes) {
  for (int to = 0; to < size(); ++to)
    if (to != rank()) send(to, tag, bytes);
}

// Handles a message that is about the run itself.
void Ranks::mind(const Message& message) {
  if (message.tag == kGone) {
    ++n_gone_;
  } else if (message.tag == kEnd && !leads() && message.from == 0) {
    throw Ended{code_of(message)};
  } else if (message.tag == kFailed && leads()) {
    const int code = code_of(message);
    if (is_ending_) return;
    throw Error(is_code(code) ? static_cast<ErrorCode>(code) : ErrorCode::internal,
                fmt::format("rank {}: {}", message.from, message.bytes.substr(sizeof code)));
  } else {
    throw Error(ErrorCode::internal,
                fmt::format("rank {} sent a message with tag {}", message.from, message.tag));
  }
}

void Ranks::look() {
  while (std::optional<Message> message = transport_->poll()) {
    if (kTagsOfRanks.hold(message->tag))
      mind(*message);
    else
      kept_.push_back(std::move(*message));
  }
}

std::optional<Message> Ranks::next(Tags tags) {
  look();
  for (auto message = kept_.begin(); message != kept_.end(); ++message) {
    if (!tags.hold(message->tag)) continue;
    Message found = std::move(*message);
    kept_.erase(message);
    return found;
  }
  return std::nullopt;
}

Message Ranks::wait(Tags tags) {
  for (;; std::this_thread::sleep_for(kNap))
    if (std::optional<Message> message = next(tags)) return std::move(*message);
}

void Ranks::end(int exit_code) {
  is_ending_ = true;
  send_to_others(kEnd, bytes_of(exit_code));
  const double since = now();
  while (n_gone_ < size() - 1 || transport_->bytes_waiting() > 0) {
    look();
    if (exit_code != 0 && now() - since > kPatience) transport_->abort(exit_code);
    std::this_thread::sleep_for(kNap);
  }
  transport_->close();
}

int Ranks::wait_for_end(const Error* failure) {
  if (failure != nullptr) send(0, kFailed, bytes_of(static_cast<int>(failure->code()), failure->what()));
  try {
    for (;; std::this_thread::sleep_for(kNap)) look();
  } catch (const Ended& ended) {
    leave();
    return ended.exit_code;
  }
}

void Ranks::leave() {
  send(0, kGone, {});
  transport_->close();
}

}  // namespace kdray::transport
