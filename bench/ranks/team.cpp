#include "bench/ranks/team.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <thread>
#include <utility>

#include "cluster/transport/message_bytes.h"
#include "cluster/transport/simulated.h"
#include "kdray/error.h"

namespace kdray::bench {

namespace {

using transport::Bytes, transport::Message, transport::Tag;

// Beyond those of kdray's own protocols (transport/ranks.h).
constexpr Tag kOfTeam = 0x1000, kHere = kOfTeam, kGo = kOfTeam + 1, kValue = kOfTeam + 2;
constexpr auto kTeamNap = std::chrono::milliseconds(2);  // others are being measured meanwhile

std::uint32_t group_of(const Message& message) {
  std::uint32_t group = 0;
  if (message.bytes.size() < sizeof group) transport::refuse(message);
  std::memcpy(&group, message.bytes.data() + message.bytes.size() - sizeof group, sizeof group);
  return group;
}

// The first that is wanted, taken out.
template <class Wanted>
std::optional<Message> take_first(std::deque<Message>& messages, const Wanted& is_wanted) {
  const auto found = std::find_if(messages.begin(), messages.end(), is_wanted);
  if (found == messages.end()) return std::nullopt;
  Message message = std::move(*found);
  messages.erase(found);
  return message;
}

Bytes bytes_of(double value) {
  return {reinterpret_cast<const char*>(&value), sizeof value};
}

}  // namespace

// A member as a rank of a group. The group's number is behind each message's bytes.
class GroupMember final : public transport::Transport {
 public:
  GroupMember(Team& team, int n, std::uint32_t group)
      : Transport(team.number(), n), team_(team), group_(group) {}

  std::size_t bytes_waiting() const override { return team_.transport_->bytes_waiting(); }
  double now() const override { return team_.transport_->now(); }
  [[noreturn]] void abort(int exit_code) override { team_.abort(exit_code); }

 private:
  void post(int to, Tag tag, Bytes bytes) override {
    bytes.append(reinterpret_cast<const char*>(&group_), sizeof group_);
    team_.transport_->send(to, tag, std::move(bytes));
  }
  std::optional<Message> take() override { return team_.next_of_group(group_); }

  Team& team_;
  std::uint32_t group_;
};

Team::Team(std::unique_ptr<transport::Transport> transport) : transport_(std::move(transport)) {}

void Team::look() {
  while (std::optional<Message> message = transport_->poll())
    (message->tag >= kOfTeam ? of_team_ : of_groups_).push_back(std::move(*message));
}

std::optional<Message> Team::next_of_group(std::uint32_t group) {
  look();
  auto found = take_first(of_groups_, [&](const Message& message) { return group_of(message) == group; });
  if (found) found->bytes.resize(found->bytes.size() - sizeof group);
  return found;
}

Message Team::wait_for(Tag tag) {
  for (;; std::this_thread::sleep_for(kTeamNap)) {
    look();
    auto found = take_first(of_team_, [&](const Message& message) { return message.tag == tag; });
    if (found) return std::move(*found);
  }
}

void Team::meet() {
  if (!leads()) {
    transport_->send(0, kHere, {});
    wait_for(kGo);
    return;
  }
  for (int n = 1; n < size(); ++n) wait_for(kHere);
  for (int to = 1; to < size(); ++to) transport_->send(to, kGo, {});
}

std::unique_ptr<transport::Transport> Team::group(int n, double delay) {
  const std::uint32_t number = ++n_groups_;
  if (this->number() >= n) return nullptr;
  auto member = std::make_unique<GroupMember>(*this, n, number);
  if (delay <= 0) return member;
  return transport::delayed(std::move(member), {.latency = delay});
}

std::vector<double> Team::gather(double own) {
  if (!leads()) {
    transport_->send(0, kValue, bytes_of(own));
    meet();
    return {};
  }
  std::vector<double> values(static_cast<std::size_t>(size()), own);
  for (int n = 1; n < size(); ++n) {
    const Message message = wait_for(kValue);
    values[static_cast<std::size_t>(message.from)] = transport::head_of<double>(message);
  }
  meet();
  return values;
}

void Team::abort(int exit_code) {
  transport_->abort(exit_code);
  std::_Exit(exit_code);
}

void Team::leave() {
  meet();
  while (transport_->bytes_waiting() > 0) look();
  transport_->close();
}

namespace {

void run_member(std::unique_ptr<transport::Transport> transport, const std::function<void(Team&)>& work) {
  Team team(std::move(transport));
  try {
    work(team);
    team.leave();
  } catch (const std::exception& error) {
    const auto* const own = dynamic_cast<const Error*>(&error);
    std::fprintf(stderr, "kdray: rank %d: %s\n", team.number(), error.what());
    team.abort(own && own->code() != ErrorCode::internal ? static_cast<int>(own->code()) : 1);
  }
}

}  // namespace

void run_team(std::unique_ptr<transport::Transport> transport, int n,
              const std::function<void(Team&)>& work) {
  if (transport) return run_member(std::move(transport), work);
  std::vector<std::unique_ptr<transport::Transport>> all = transport::in_process(n);
  std::vector<std::jthread> threads;
  for (std::size_t i = 1; i < all.size(); ++i)
    threads.emplace_back([&, i] { run_member(std::move(all[i]), work); });
  run_member(std::move(all.front()), work);
}

}  // namespace kdray::bench
