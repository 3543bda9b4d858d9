#include "bench/ranks/simulate_pdprt.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>

#include "base/error.h"
#include "bench/ranks/sim_host.h"
#include "pdprt/borrower.h"
#include "pdprt/lender.h"

namespace kdray::bench {

namespace {

// They are those of pdprt/frame_lists.cpp.
constexpr double kForeverAList = 1e9, kDeliverEvery = 1.0;

constexpr double kNever = std::numeric_limits<double>::infinity();

// A rank with its protocol, and one queue.
struct PretendRank {
  PretendRank(std::unique_ptr<transport::Transport> transport, const ReplayedFrame& frame,
              const pdprt::SharedFrame& shared, bool is_first)
      : ranks(std::move(transport)),
        queue(frame, is_first ? kForeverAList : kDeliverEvery,
              is_first ? frame.take_back_seconds : frame.deliver_seconds) {
    const pdprt::Bags bags(ranks.size());
    ranks.leads() ? void(lender.emplace(ranks, shared, bags)) : void(borrower.emplace(ranks, shared, bags));
  }

  struct Open {  // Tiles don't move
    Open(std::size_t n_queues, std::size_t capacity) : tiles(pdprt::Tiles::open(n_queues, capacity)) {}
    pdprt::Tiles tiles;
  };

  transport::Ranks ranks;
  std::optional<pdprt::Lender> lender;
  std::optional<pdprt::Borrower> borrower;
  std::optional<Open> tiles;
  PretendQueue queue;
  bool is_ready = false, in_list = false;
  double next_look = kNever;
};

class PdprtSimulation {
 public:
  PdprtSimulation(const ReplayedFrame& frame, const RanksSetting& setting)
      : frame_(frame),
        setting_(setting),
        shared_{hash_of(std::string("a simulated frame")), frame.width, frame.height, frame.tile_width,
                frame.tile_height},
        network_(setting.ranks, link_of(setting), setting.seed),
        cores_(setting.speed),
        film_(3 * std::size_t{frame.width} * frame.height),
        random_(setting.seed) {
    const HostCosts costs{.send = setting.messages.send,
                          .take = setting.messages.take,
                          .take_byte_of = {pdprt::kPieces, take_back_of_byte()}};
    for (int r = 0; r < setting.ranks; ++r) {
      ranks_.push_back(std::make_unique<PretendRank>(std::make_unique<SimHost>(network_, r, costs), frame,
                                                     shared_, r == 0));
      phases_.push_back(setting.look * static_cast<double>(random_() >> 11) * 0x1p-53);
    }
  }

  SimulatedRanks run() {
    // Rank 0 tells of the frame, then all make themselves ready for it.
    cores_.start(0, frame_.prepare_seconds);
    for (int r = 1; r < setting_.ranks; ++r) {
      const double hears = setting_.messages.latency + setting_.delay + setting_.messages.send * r;
      hears_.push({hears + phases_[static_cast<std::size_t>(r)], r});
    }
    while (!is_done()) step();
    SimulatedRanks outcome;
    outcome.seconds = network_.free_at(0) - began_ + frame_.end_seconds / setting_.speed(1);
    for (const auto& rank : ranks_) outcome.busy += rank->queue.busy();
    outcome.least_ready = least_ready_ == kNever ? 0 : least_ready_ - began_;
    outcome.most_ready = std::max(0.0, most_ready_ - began_);
    const transport::Counters& counters = ranks_.front()->ranks.counters();
    outcome.messages = counters.sent + counters.received;
    outcome.bytes = counters.bytes_sent + counters.bytes_received;
    outcome.events = n_events_;
    return outcome;
  }

 private:
  double take_back_of_byte() const {
    return frame_.take_back_seconds / (24.0 * frame_.tile_width * frame_.tile_height);
  }

  bool is_done() const {
    const PretendRank& first = *ranks_.front();
    return first.is_ready && first.lender->is_done() && first.queue.is_over();
  }

  // To whatever happens next.
  void step() {
    const double look = looks_.empty() ? kNever : looks_.top().first;
    const double hears = hears_.empty() ? kNever : hears_.top().first;
    const double next = std::min({network_.next_arrival(), cores_.next_end(), look, hears});
    if (next == kNever) throw Error(ErrorCode::internal, "the simulated ranks stand still");
    ++n_events_;
    cores_.advance(std::max(next, network_.now()));
    network_.advance(next);
    for (const int r : network_.take_reached()) look_soon(r);
    for (; !hears_.empty() && hears_.top().first <= network_.now(); hears_.pop())
      cores_.start(hears_.top().second, frame_.prepare_seconds);
    while (const auto r = cores_.take_ended()) end_work(*r);
    while (!looks_.empty() && looks_.top().first <= network_.now()) {
      const auto [at, r] = looks_.top();
      looks_.pop();
      PretendRank& rank = *ranks_[static_cast<std::size_t>(r)];
      if (rank.next_look != at) continue;  // an earlier one was wanted
      rank.next_look = kNever;
      if (const double free = network_.free_at(r); free > network_.now())
        look_at(rank, r, free);
      else
        act(r);
    }
  }

  // When the rank's thread looks next. One that is occupied naps when it is done.
  void look_soon(int r) {
    PretendRank& rank = *ranks_[static_cast<std::size_t>(r)];
    const double now = network_.now(), free = network_.free_at(r),
                 phase = phases_[static_cast<std::size_t>(r)];
    const double grid = phase + setting_.look * std::ceil((now - phase) / setting_.look);
    look_at(rank, r, free > now ? free + setting_.look : std::max(grid, now));
  }

  void look_at(PretendRank& rank, int r, double at) {
    if (at >= rank.next_look) return;
    rank.next_look = at;
    looks_.push({at, r});
  }

  void end_work(int r) {
    PretendRank& rank = *ranks_[static_cast<std::size_t>(r)];
    if (!rank.is_ready) {
      rank.is_ready = true;
      const double now = network_.now();
      if (r == 0) {
        began_ = now;
        begin();
      } else {
        least_ready_ = std::min(least_ready_, now), most_ready_ = std::max(most_ready_, now);
        look_at(rank, r, now);
      }
      return;
    }
    move(r, true);
  }

  void begin() {
    PretendRank& first = *ranks_.front();
    first.tiles.emplace(1, frame_.curve.size());
    first.queue.begin(first.tiles->tiles);
    first.lender->begin({}, frame_.curve, {}, [](layout::u32, ledger::Sums) {});
    act(0);
  }

  // What a rank's thread does at a look.
  void act(int r) {
    PretendRank& rank = *ranks_[static_cast<std::size_t>(r)];
    if (!rank.is_ready) return;
    if (rank.lender) {
      rank.lender->step(rank.tiles->tiles);
    } else if (rank.in_list) {
      rank.borrower->step(rank.tiles->tiles, rank.queue.n_rendered());
    } else {
      const auto list = rank.borrower->next_list();
      if (!list) return;
      rank.in_list = true;
      // As many as may come, but for what is no more than a reserve here.
      const std::size_t share = 8 * frame_.curve.size() / static_cast<std::size_t>(setting_.ranks) + 64;
      rank.tiles.emplace(1, std::min<std::size_t>(list->head.n_entries, share));
      rank.queue.begin(rank.tiles->tiles);
      rank.borrower->step(rank.tiles->tiles, 0);
    }
    move(r, false);
  }

  // Lets the queue go on with what there is.
  void move(int r, bool ended) {
    PretendRank& rank = *ranks_[static_cast<std::size_t>(r)];
    const bool had_work = !ended && rank.queue.is_at_work();
    if (had_work || !rank.tiles) return;
    const auto deliver = [&](std::span<const layout::u32> entries) {
      if (rank.borrower) rank.borrower->deliver(wavefront::FilmSums{film_, 0}, entries);
    };
    if (const auto work = rank.queue.go_on(network_.now(), ended, deliver)) cores_.start(r, *work);
    if (rank.borrower && rank.in_list && rank.queue.is_over() && rank.borrower->is_done()) {
      rank.borrower->finish_list();
      rank.in_list = false;
    }
    if (ended) look_soon(r);
  }

  using At = std::pair<double, int>;
  using Soonest = std::priority_queue<At, std::vector<At>, std::greater<>>;

  const ReplayedFrame& frame_;
  const RanksSetting& setting_;
  pdprt::SharedFrame shared_;
  transport::Network network_;
  SharedCores cores_;
  std::vector<layout::i64> film_;  // what all of them deliver
  std::mt19937_64 random_;
  std::vector<std::unique_ptr<PretendRank>> ranks_;
  std::vector<double> phases_;  // of the looks
  Soonest looks_, hears_;
  double began_ = 0, least_ready_ = kNever, most_ready_ = 0;
  std::size_t n_events_ = 0;
};

}  // namespace

transport::Link link_of(const RanksSetting& setting) {
  const MessageCosts& m = setting.messages;
  transport::Link link{.latency = m.latency + setting.delay, .bandwidth = m.bandwidth, .comes_in_turn = true};
  link.of_bytes = [m, look = setting.look](std::size_t bytes) {
    return look * (bytes >= kLongBytes           ? m.looks_of_long
                   : bytes >= kMiddlingBytes / 2 ? m.looks_of_middling
                                                 : 0);
  };
  if (setting.moved_by_looks) link.bandwidth = std::min(link.bandwidth, m.bytes_of_look / setting.look);
  return link;
}

SimulatedRanks simulate_pdprt(const ReplayedFrame& frame, const RanksSetting& setting) {
  return PdprtSimulation(frame, setting).run();
}

}  // namespace kdray::bench
