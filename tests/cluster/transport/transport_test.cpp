// Ranks in one process and over the simulated network: messages come once and whole; the simulation's times
// are those of its link, and its seed decides all.
#include "cluster/transport/transport.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <thread>
#include <tuple>

#include "cluster/transport/exercise.h"
#include "cluster/transport/simulated.h"
#include "kdray/error.h"

namespace kdray::transport {
namespace {

TEST(InProcessTest, EveryMessageComesOnceAndWhole) {
  for (const int ranks : {1, 2, 5}) {
    const auto all = in_process(ranks);
    std::vector<std::jthread> threads;
    for (const auto& rank : all)
      threads.emplace_back([&rank] {
        for (test::Exercise exercise(*rank, 40); exercise.step();) std::this_thread::yield();
      });
    threads.clear();
    for (const auto& rank : all) {
      EXPECT_EQ(rank->counters().sent, static_cast<std::uint64_t>(40 * ranks));
      EXPECT_EQ(rank->counters().received, rank->counters().sent);
      EXPECT_FALSE(rank->poll());
    }
  }
}

TEST(InProcessTest, WhatCantBeSentIsRefused) {
  const auto all = in_process(2);
  for (const auto& [to, tag] : {std::pair{2, 0}, {-1, 0}, {0, kMostTag + 1}})
    EXPECT_THROW(all[0]->send(to, static_cast<Tag>(tag), "x"), Error) << to << " " << tag;
}

TEST(DelayedTest, MessagesComeLater) {
  Network network(2, {.latency = 0.5}, 1);
  // The other rank's transport is the network's own.
  class Of final : public Transport {
   public:
    explicit Of(Transport& from) : Transport(from.rank(), from.ranks()), from_(from) {}
    std::size_t bytes_waiting() const override { return 0; }
    double now() const override { return from_.now(); }
    [[noreturn]] void abort(int) override { throw std::runtime_error("aborted"); }

   private:
    void post(int to, Tag tag, Bytes bytes) override { from_.send(to, tag, std::move(bytes)); }
    std::optional<Message> take() override { return from_.poll(); }
    Transport& from_;
  };
  const auto late = delayed(std::make_unique<Of>(network.rank(1)), {.latency = 1, .bandwidth = 10});
  network.rank(0).send(1, 1, Bytes(10, 'a'));
  network.rank(0).send(1, 2, Bytes(20, 'b'));
  network.advance(0.5);
  EXPECT_FALSE(late->poll());
  network.advance(2.4);
  EXPECT_FALSE(late->poll());
  network.advance(2.6);
  EXPECT_EQ(late->poll()->tag, 1);
  EXPECT_FALSE(late->poll());
  network.advance(4.6);
  EXPECT_EQ(late->poll()->bytes, Bytes(20, 'b'));
}

TEST(SimulatedTest, EveryMessageComesOnceAndWhole) {
  Network network(5, {.latency = 1e-3, .jitter = 10, .bandwidth = 1e8}, 7);
  std::vector<test::Exercise> exercises;
  for (int rank = 0; rank < 5; ++rank) exercises.emplace_back(network.rank(rank), 40);
  for (bool goes_on = true; goes_on;) {
    goes_on = false;
    for (test::Exercise& exercise : exercises) goes_on = exercise.step() || goes_on;
    if (goes_on) {
      ASSERT_LT(network.next_arrival(), 1e9);
      network.advance(network.next_arrival());
    }
  }
}

TEST(SimulatedTest, TimesAreThoseOfTheLink) {
  Network network(3, {.latency = 0.25, .jitter = 0, .bandwidth = 1000}, 1);
  network.rank(0).send(1, 5, Bytes(500, 'a'));
  network.rank(0).send(2, 6, Bytes(1000, 'b'));  // leaves when the first has left
  network.rank(1).send(1, 7, "to itself");
  EXPECT_NEAR(network.next_arrival(), 0.009, 1e-12);
  network.advance(0.5);
  EXPECT_EQ(network.rank(1).poll()->tag, 7);
  EXPECT_FALSE(network.rank(1).poll());
  EXPECT_NEAR(network.next_arrival(), 0.75, 1e-12);
  network.advance(1.0);
  EXPECT_EQ(network.rank(1).poll()->bytes.size(), 500u);
  EXPECT_FALSE(network.rank(2).poll());
  EXPECT_NEAR(network.next_arrival(), 1.75, 1e-12);
}

// What comes in which order, and when.
std::vector<std::tuple<double, int, int>> arrivals(std::uint64_t seed) {
  Network network(2, {.latency = 1e-3, .jitter = 5, .bandwidth = 1e9}, seed);
  for (int i = 0; i < 50; ++i) network.rank(0).send(1, static_cast<Tag>(i), Bytes(100, 'x'));
  std::vector<std::tuple<double, int, int>> all;
  while (network.next_arrival() < 1e9) {
    network.advance(network.next_arrival());
    while (const auto message = network.rank(1).poll())
      all.emplace_back(network.now(), message->from, message->tag);
  }
  return all;
}

TEST(SimulatedTest, TheSeedDecidesTheOrder) {
  const auto first = arrivals(1);
  ASSERT_EQ(first.size(), 50u);
  EXPECT_EQ(first, arrivals(1));
  EXPECT_NE(first, arrivals(2));
  int overtaken = 0;
  for (std::size_t i = 1; i < first.size(); ++i)
    overtaken += std::get<2>(first[i]) < std::get<2>(first[i - 1]);
  EXPECT_GT(overtaken, 5);
}

}  // namespace
}  // namespace kdray::transport
