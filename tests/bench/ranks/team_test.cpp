// A team of threads: all meet, groups keep their messages apart, values come home, and a ping-pong tells
// something.
#include "bench/ranks/team.h"

#include <gtest/gtest.h>

#include <atomic>

#include "bench/ranks/bench.h"

namespace kdray::bench {
namespace {

TEST(TeamTest, NobodyGoesOnBeforeAllAreThere) {
  std::atomic<int> n_there{0};
  run_team(nullptr, 5, [&](Team& team) {
    ++n_there;
    team.meet();
    EXPECT_EQ(n_there, 5);
    team.meet();
    const auto values = team.gather(team.number() + 0.5);
    EXPECT_EQ(values, team.leads() ? std::vector({0.5, 1.5, 2.5, 3.5, 4.5}) : std::vector<double>());
  });
}

// What is sent to a member in a group that it is not at yet waits for it, also behind an earlier group's.
TEST(TeamTest, GroupsKeepTheirMessagesApart) {
  run_team(nullptr, 3, [](Team& team) {
    auto first = team.group(2), second = team.group(3);
    EXPECT_EQ(first == nullptr, team.number() == 2);
    EXPECT_EQ(second->ranks(), 3);
    if (team.leads()) {
      second->send(1, 7, "later");
      first->send(1, 7, "sooner");
    } else if (team.number() == 1) {
      std::optional<transport::Message> message;
      while (!(message = first->poll())) {
      }
      EXPECT_EQ(message->bytes, "sooner");
      while (!(message = second->poll())) {
      }
      EXPECT_EQ(message->bytes, "later");
      EXPECT_EQ(first->counters().bytes_received, 6u);
    }
    team.meet();
  });
}

TEST(TeamTest, APingPongTellsWhatMessagesCost) {
  run_team(nullptr, 3, [](Team& team) {
    const MessageCosts costs = ping_pong(team);
    if (!team.leads()) return;
    EXPECT_GT(costs.latency, 0);
    EXPECT_LT(costs.latency, 1);
    EXPECT_GT(costs.bandwidth, 0);
    EXPECT_GT(costs.send, 0);
    EXPECT_GT(costs.take, 0);
  });
}

}  // namespace
}  // namespace kdray::bench
