// The protocol by which ranks share a list of tiles, over a network that is simulated: with any latency,
// bandwidth and order of messages each tile is rendered once and its sums come home; ranks don't wait for
// tiles; and messages that make no sense are refused. Rendering is only pretended: a tile takes its time, and
// its sums are its number's.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <numeric>
#include <random>
#include <set>
#include <stdexcept>

#include "cluster/transport/simulated.h"
#include "engine/pdprt/tile_client.h"
#include "engine/pdprt/tile_server.h"
#include "engine/wavefront/tile_order.h"
#include "support/errors.h"

namespace kdray::pdprt {
namespace {

constexpr std::uint32_t kSide = 8;

constexpr std::uint32_t kWidth = 150, kHeight = 90, kTiles = 19 * 12;

SharedFrame frame_of(const std::string& name, std::uint32_t side = kSide) {
  return {hash_of(name), kWidth, kHeight, side, side};
}

// What rendering an entry would give at a place.
layout::i64 value_at(layout::u32 entry, std::size_t place) {
  return static_cast<layout::i64>(entry * 0x9e3779b97f4a7c15u + place);
}

// The transport of a network's rank, for Ranks to own.
class RankOf final : public transport::Transport {
 public:
  explicit RankOf(transport::Transport& from) : Transport(from.rank(), from.ranks()), from_(from) {}
  std::size_t bytes_waiting() const override { return 0; }
  double now() const override { return from_.now(); }
  [[noreturn]] void abort(int code) override {
    throw std::runtime_error(fmt::format("aborted with {}", code));
  }

 private:
  void post(int to, transport::Tag tag, transport::Bytes bytes) override {
    from_.send(to, tag, std::move(bytes));
  }
  std::optional<transport::Message> take() override { return from_.poll(); }
  transport::Transport& from_;
};

// A queue that only takes its time for each entry, and has a film.
class Pretender {
 public:
  Pretender(const SharedFrame& frame, double seconds, std::uint64_t seed)
      : frame_(frame), seconds_(seconds), random_(seed), film_(3 * std::size_t{kWidth} * kHeight) {}

  void begin(bool of_runs) {
    of_runs_ = of_runs;
    tiles_.emplace(1, kWidth * kHeight / (frame_.tile_width * frame_.tile_height) + kTiles);
  }

  // What a list has is delivered when some entries are done, or when no more are there.
  template <class Deliver>
  void go_on(double now, const Deliver& deliver) {
    if (in_work_ && now < until_) return;
    if (in_work_) done_.push_back(*in_work_), in_work_.reset(), ++n_rendered_;
    if (ahead_.empty() && done_.size() < 16) take();
    if (ahead_.empty() && !done_.empty()) {
      const std::span<const layout::i64> film = film_;
      deliver(wavefront::PlacedFilms{{&film, 1}, 0, kWidth}, done_);
      tiles().done(0);
      done_.clear();
      take();
    }
    if (ahead_.empty()) return;
    in_work_ = ahead_.front();
    ahead_.erase(ahead_.begin());
    render(*in_work_);
    const double took = seconds_ * (0.2 + 1.6 * static_cast<double>(random_() >> 11) * 0x1p-53);
    busy_ += took;
    until_ = now + took;
  }

  Tiles& tiles() { return tiles_->tiles; }
  double next_event() const { return in_work_ ? until_ : std::numeric_limits<double>::infinity(); }
  std::size_t n_rendered() const { return n_rendered_; }
  double busy() const { return busy_; }

 private:
  struct Open {
    Open(std::size_t n_queues, std::size_t capacity) : tiles(Tiles::open(n_queues, capacity)) {}
    Tiles tiles;
  };

  void take() {
    const auto more = tiles().take(0, {.most = 3, .least = 1, .ahead = 0});
    ahead_.assign(more.begin(), more.end());
  }

  void render(layout::u32 entry) {
    const checkpoint::Rectangle r = frame_.places_of(of_runs_, entry);
    for (std::size_t y = 0; y < r.height; ++y)
      for (std::size_t i = 0; i < std::size_t{3} * r.width; ++i) {
        const std::size_t place = 3 * ((r.y + y) * kWidth + r.x) + i;
        film_[place] = value_at(entry, place);
      }
  }

  SharedFrame frame_;
  double seconds_;
  std::mt19937_64 random_;
  std::vector<layout::i64> film_;
  bool of_runs_ = false;
  std::optional<Open> tiles_;
  std::vector<layout::u32> ahead_, done_;
  std::optional<layout::u32> in_work_;
  double until_ = 0, busy_ = 0;
  std::size_t n_rendered_ = 0;
};

struct Outcome {
  double seconds = 0, busy = 0;
  std::uint64_t messages = 0;
  std::vector<std::size_t> rendered;  // by rank
};

// Some lists of a frame, by ranks of a simulated network.
class Simulation {
 public:
  Simulation(const TileHierarchy& hierarchy, int n, const transport::Link& link, double seconds_per_entry,
             std::uint64_t seed, std::uint32_t side = kSide)
      : frame_(frame_of("a frame", side)), network_(n, link, seed) {
    for (int rank = 0; rank < n; ++rank) {
      ranks_.push_back(std::make_unique<transport::Ranks>(std::make_unique<RankOf>(network_.rank(rank))));
      queues_.push_back(
          std::make_unique<Pretender>(frame_, seconds_per_entry, seed * 64 + static_cast<unsigned>(rank)));
      if (rank > 0) clients_.push_back(std::make_unique<TileClient>(*ranks_.back(), frame_, hierarchy));
    }
    server_.emplace(*ranks_.front(), frame_, hierarchy);
    in_list_.resize(static_cast<std::size_t>(n));
  }

  // `close_at`: when the list's time is over.
  std::vector<layout::u32> render(std::vector<layout::u32> entries, bool of_runs, double close_at = 1e9) {
    seen_.clear();
    queues_.front()->begin(of_runs);
    const std::vector<layout::u32> samples(of_runs ? 512 : 0);
    server_->begin({.of_runs = of_runs ? 1u : 0u}, entries, samples,
                   [&](const wavefront::PlacedFilms& films, std::span<const layout::u32> taken) {
                     const layout::u32 entry = taken.front();
                     const checkpoint::Rectangle r = frame_.places_of(of_runs, entry);
                     for (std::size_t y = r.y; y < r.y + r.height; ++y)
                       for (std::size_t i = 0; i < std::size_t{3} * r.width; ++i)
                         ASSERT_EQ(films.films.front()[films.at(r.x, y) + i],
                                   value_at(entry, 3 * (y * kWidth + r.x) + i));
                     EXPECT_TRUE(seen_.insert(entry).second) << "twice: " << entry;
                   });
    std::vector<layout::u32> left;
    const double since = network_.now();
    for (int guard = 0; !(server_->is_done() && queues_.front()->tiles().is_over()); ++guard) {
      if (guard > 1000000) throw std::runtime_error("it hangs");
      if (left.empty() && network_.now() - since >= close_at) left = server_->close();
      act();
      advance();
    }
    for (const layout::u32 entry : left)
      EXPECT_TRUE(seen_.insert(entry).second) << "left and rendered: " << entry;
    EXPECT_EQ(seen_.size(), entries.size());
    return left;
  }

  void finish() {
    for (server_->finish(); !server_->take_reports(); advance()) act_of_others();
    for (const auto& client : clients_) EXPECT_TRUE(client->is_finished());
  }

  double received_by_first() const { return static_cast<double>(ranks_.front()->counters().received); }

  Outcome outcome() const {
    Outcome o{network_.now(), 0, 0, {}};
    for (const auto& queue : queues_) o.busy += queue->busy(), o.rendered.push_back(queue->n_rendered());
    for (const auto& ranks : ranks_) o.messages += ranks->counters().sent;
    return o;
  }

 private:
  void act() {
    Pretender& own = *queues_.front();
    server_->step(own.tiles());
    own.go_on(network_.now(), [&](const wavefront::PlacedFilms&, std::span<const layout::u32> entries) {
      for (const layout::u32 entry : entries) EXPECT_TRUE(seen_.insert(entry).second) << "twice: " << entry;
    });
    server_->step(own.tiles());
    act_of_others();
  }

  void act_of_others() {
    for (std::size_t rank = 1; rank < ranks_.size(); ++rank)
      act_of(rank, *clients_[rank - 1], *queues_[rank]);
  }

  void act_of(std::size_t rank, TileClient& client, Pretender& queue) {
    if (!in_list_[rank]) {
      if (client.is_finished()) return;
      const auto list = client.next_list();
      if (client.is_finished()) ranks_[rank]->send(0, kReport, "done");
      if (!list) return;
      in_list_[rank] = true;
      queue.begin(list->head.of_runs != 0);
    }
    client.step(queue.tiles(), queue.n_rendered());
    queue.go_on(network_.now(), [&](const wavefront::PlacedFilms& films,
                                    std::span<const layout::u32> entries) { client.take(films, entries); });
    client.step(queue.tiles(), queue.n_rendered());
    if (!queue.tiles().is_over() || !client.is_done()) return;
    client.finish_list();
    in_list_[rank] = false;
  }

  // To whatever happens next; ranks look at their messages every millisecond at least.
  void advance() {
    double next = std::min(network_.next_arrival(), network_.now() + 1e-3);
    for (const auto& queue : queues_) next = std::min(next, std::max(queue->next_event(), network_.now()));
    network_.advance(next);
  }

  SharedFrame frame_;
  transport::Network network_;
  std::vector<std::unique_ptr<transport::Ranks>> ranks_;
  std::vector<std::unique_ptr<Pretender>> queues_;
  std::vector<std::unique_ptr<TileClient>> clients_;
  std::optional<TileServer> server_;
  std::vector<bool> in_list_;
  std::set<layout::u32> seen_;
};

std::vector<layout::u32> all_tiles() {
  return wavefront::tile_curve(19, 0, 12);
}

TEST(TileServer, EveryTileIsRenderedOnceInAnyOrderOfMessages) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    std::mt19937_64 random(seed);
    const auto pick = [&](std::uint64_t lo, std::uint64_t hi) { return lo + random() % (hi - lo + 1); };
    const int n = static_cast<int>(pick(1, 20));
    const transport::Link link{.latency = 1e-5 * std::pow(10.0, static_cast<double>(pick(0, 4))),
                               .jitter = static_cast<double>(pick(0, 20)),
                               .bandwidth = std::pow(10.0, static_cast<double>(pick(6, 10)))};
    const TileHierarchy hierarchy(n, static_cast<int>(pick(2, 12)));
    SCOPED_TRACE(fmt::format("seed {}: {} ranks, the first serves {}, latency {}, jitter {}, bandwidth {}",
                             seed, n, hierarchy.clients_of(0).size(), link.latency, link.jitter,
                             link.bandwidth));
    Simulation simulation(hierarchy, n, link, 1e-4 * static_cast<double>(pick(1, 100)), seed);
    const auto left = simulation.render(all_tiles(), false, 0.01 * static_cast<double>(pick(1, 50)));
    if (!left.empty()) simulation.render(left, false);
    std::vector<layout::u32> runs(pick(1, 40));
    std::iota(runs.begin(), runs.end(), 0u);
    simulation.render(runs, true);
    simulation.render({0}, false);
    simulation.finish();
    if (HasFailure()) return;
  }
}

// The bar of PDPRT with 5 ms of round trip: 0.95. The network's delay is in no tile's way.
TEST(TileServer, RanksDontWaitForTiles) {
  for (const double latency : {20e-6, 2.5e-3}) {
    Simulation simulation(TileHierarchy(4), 4, {.latency = latency, .jitter = 1, .bandwidth = 1e8}, 0.05, 3);
    simulation.render(all_tiles(), false);
    const Outcome o = simulation.outcome();
    EXPECT_GT(o.busy / (4 * o.seconds), 0.95) << latency;
    EXPECT_LT(o.messages, 400u);
    for (const std::size_t n : o.rendered) EXPECT_NEAR(static_cast<double>(n), kTiles / 4.0, kTiles / 16.0);
  }
}

// Ranks that are served by one of their own group, which the first serves: as busy, and the first has few
// messages.
TEST(TileServer, BagsOfBags) {
  const auto outcome_of = [](const TileHierarchy& hierarchy) {
    Simulation simulation(hierarchy, 100, {.latency = 20e-6, .jitter = 1, .bandwidth = 1e9}, 0.02, 3, 2);
    simulation.render(wavefront::tile_curve(75, 0, 45), false);
    return std::pair(simulation.outcome(), simulation.received_by_first());
  };
  const auto [one, one_received] = outcome_of(TileHierarchy(100, 100));
  const auto [several, several_received] = outcome_of(TileHierarchy(100));
  EXPECT_LT(several.seconds, 1.05 * one.seconds);
  EXPECT_LT(several_received, 0.5 * one_received);
}

TEST(TileServer, WhatMakesNoSenseIsRefused) {
  const auto refused = [](transport::Tag tag, const transport::Bytes& bytes) {
    transport::Network network(2, {.latency = 0}, 1);
    transport::Ranks first(std::make_unique<RankOf>(network.rank(0)));
    TileServer server(first, frame_of("a frame"), TileHierarchy(2));
    Tiles own = Tiles::open(1, kTiles);
    server.begin({}, {0, 1, 2}, {},
                 [](const wavefront::PlacedFilms&, std::span<const layout::u32>) { FAIL() << "taken"; });
    network.rank(1).send(0, tag, bytes);
    network.advance(1);
    return test::fails([&] { server.step(own); }, "rank 1 sent", ErrorCode::internal);
  };
  std::string record;
  const std::vector<layout::i64> sums(3 * 64);
  checkpoint::append_record(record, frame_of("a frame").frame, {0, 2, {16, 0, 8, 8}}, sums,
                            checkpoint::hash_of_sums(sums));
  EXPECT_TRUE(refused(kWant, "x"));
  EXPECT_TRUE(refused(kGrant, to_bytes(Grant{1, 0, 0})));
  EXPECT_TRUE(refused(kRecords, to_bytes(Records{7, 0})));                 // of another list
  EXPECT_TRUE(refused(kRecords, to_bytes(Records{1, 0}).append(record)));  // that nobody asked it for
  EXPECT_TRUE(refused(kRecords, to_bytes(Records{1, 0}).append(record.substr(0, 90))));  // half a record
  EXPECT_TRUE(refused(kRecords, to_bytes(Records{1, 0}).append("x")));
}

TEST(TileServer, WhatMakesNoSenseIsRefusedByOthersToo) {
  const auto refused = [](transport::Tag tag, const transport::Bytes& bytes) {
    transport::Network network(2, {.latency = 0}, 1);
    transport::Ranks second(std::make_unique<RankOf>(network.rank(1)));
    TileClient client(second, frame_of("a frame"), TileHierarchy(2));
    const Begin head{.list = 5, .n_entries = 3};
    network.rank(0).send(1, kBegin, to_bytes(head));
    network.advance(1);
    EXPECT_EQ(client.next_list()->head.n_entries, 3u);
    Tiles tiles = Tiles::open(1, 3);
    network.rank(0).send(1, tag, bytes);
    network.advance(2);
    return test::fails([&] { client.step(tiles, 0); }, "rank 0 sent", ErrorCode::internal);
  };
  using Entries = std::vector<layout::u32>;
  EXPECT_TRUE(refused(kGrant, "x"));
  EXPECT_TRUE(refused(kGrant, to_bytes(Grant{6, 0, 0})));  // of a list that isn't yet
  EXPECT_TRUE(refused(kGrant, to_bytes(Grant{5, 0, 0}, Entries{KDRAY_TILE(19, 0)})));  // right of the picture
  EXPECT_TRUE(refused(kGrant, to_bytes(Grant{5, 0, 0}, Entries{0, 1, 2, 3})));         // more than there are
  EXPECT_TRUE(refused(kGrant, to_bytes(Grant{5, 0, 0}) + "xyz"));
  EXPECT_TRUE(refused(kWant, to_bytes(Want{5, 1, 0, 0})));
  EXPECT_FALSE(refused(kGrant, to_bytes(Grant{4, 0, 0}, Entries{0})));  // of a list that is over
  EXPECT_FALSE(refused(kGrant, to_bytes(Grant{5, 0, 0}, Entries{0, 1, 2})));
}

// Of three ranks, of which the first serves the second and the second the third, each
// takes only what comes from its own server or client.
TEST(TileServer, StrangersAreRefused) {
  const TileHierarchy hierarchy(4, 2);  // two groups of two
  transport::Network network(4, {.latency = 0}, 1);
  const auto ranks_of = [&](int rank) {
    return transport::Ranks(std::make_unique<RankOf>(network.rank(rank)));
  };
  transport::Ranks first = ranks_of(0), third = ranks_of(2);
  Tiles own = Tiles::open(1, kTiles);
  TileServer server(first, frame_of("a frame"), hierarchy);
  server.begin({}, {0, 1, 2}, {},
               [](const wavefront::PlacedFilms&, std::span<const layout::u32>) { FAIL() << "taken"; });
  TileClient client(third, frame_of("a frame"), hierarchy);
  network.advance(1);
  ASSERT_TRUE(client.next_list());
  network.rank(3).send(0, kWant, to_bytes(Want{1, 1, 0, 0}));  // which the third serves
  network.rank(1).send(2, kWant, to_bytes(Want{1, 1, 0, 0}));
  network.advance(2);
  EXPECT_TRUE(test::fails([&] { server.step(own); }, "rank 3 sent", ErrorCode::internal));
  EXPECT_TRUE(test::fails([&] { client.step(own, 0); }, "rank 1 sent", ErrorCode::internal));
  network.rank(3).send(2, kGrant, to_bytes(Grant{1, 0, 0}, std::vector<layout::u32>{0}));
  network.advance(3);
  EXPECT_TRUE(test::fails([&] { client.step(own, 0); }, "rank 3 sent", ErrorCode::internal));
}

// A record that the rank was asked for, changed on its way.
TEST(TileServer, DamagedPiecesAreRefused) {
  const auto result_of = [](const std::function<void(std::string&)>& change) {
    transport::Network network(2, {.latency = 0}, 1);
    transport::Ranks first(std::make_unique<RankOf>(network.rank(0)));
    const SharedFrame frame = frame_of("a frame");
    TileServer server(first, frame, TileHierarchy(2));
    Tiles own = Tiles::open(1, kTiles);
    own.add(std::vector<layout::u32>(10), 0);  // so that rank 0 has enough, and gives all away
    int n_taken = 0;
    const layout::u32 tile = KDRAY_TILE(2, 1);
    server.begin({}, {tile}, {},
                 [&](const wavefront::PlacedFilms&, std::span<const layout::u32>) { ++n_taken; });
    network.rank(1).send(0, kWant, to_bytes(Want{1, 5, 0, 0}));
    network.advance(1);
    server.step(own);
    std::string record;
    const std::vector<layout::i64> sums(3 * 64, 5);
    checkpoint::append_record(record, frame.frame, {0, tile, frame.places_of(false, tile)}, sums,
                              checkpoint::hash_of_sums(sums));
    change(record);
    network.rank(1).send(0, kRecords, to_bytes(Records{1, 0}).append(record));
    network.advance(2);
    const bool refused =
        static_cast<bool>(test::fails([&] { server.step(own); }, "rank 1 sent", ErrorCode::internal));
    return std::pair(refused, n_taken);
  };
  EXPECT_EQ(result_of([](std::string&) {}), std::pair(false, 1));
  EXPECT_EQ(result_of([](std::string& r) { r += r; }), std::pair(true, 1));  // twice
  for (const std::size_t at : {0, 9, 17, 40, 60, 80, 88, 500})
    EXPECT_EQ(result_of([at](std::string& r) { r[at] = static_cast<char>(r[at] + 1); }), std::pair(true, 0))
        << at;
}

}  // namespace
}  // namespace kdray::pdprt
