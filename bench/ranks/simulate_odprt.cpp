#include "bench/ranks/simulate_odprt.h"

#include <algorithm>
#include <memory>
#include <random>

#include "base/error.h"
#include "bench/ranks/sim_host.h"
#include "layout/features.h"
#include "odprt/post.h"

namespace kdray::bench {

namespace {

constexpr double kNeverYet = std::numeric_limits<double>::infinity();
constexpr double kBytesOfPixel = 24, kBytesOfMessage = 1 << 20;  // of sums
// The thread naps so much shorter between two looks than PDPRT's, whose looks were measured (odprt/band.cpp).
constexpr double kShorterNap = 0.5e-3;

layout::Features features_of(const LivedFrame& lived) {
  layout::Features features = 0;
  if (lived.n_lights > 0) features |= KDRAY_FEATURE_LIGHTS;
  if (lived.reflects) features |= KDRAY_FEATURE_REFLECT;
  if (lived.transmits) features |= KDRAY_FEATURE_TRANSMIT;
  return features;
}

// ODPRT's own plan for ranks of one queue on one core.
odprt::Plan plan_of(const LivedFrame& lived, std::size_t n_tiles, int ranks) {
  layout::Frame frame{};
  frame.width = static_cast<layout::u32>(lived.width), frame.height = static_cast<layout::u32>(lived.height);
  frame.n_tiles = static_cast<layout::u32>(n_tiles);
  frame.max_depth = static_cast<layout::u32>(lived.depth);
  frame.n_lights = static_cast<layout::u32>(lived.n_lights);
  const auto n = static_cast<std::uint32_t>(ranks);
  return odprt::make_plan(
      frame, {.features = features_of(lived), .n_parts = n, .n_queues = n, .n_ranks = n, .n_slices = 1});
}

// A rank of one queue and one part.
class PretendPart {
 public:
  PretendPart(std::unique_ptr<transport::Transport> transport, const LivedFrame& lived,
              const DividedFrame& frame, const odprt::Plan& plan, const OdprtCosts& costs,
              std::span<const std::vector<std::uint32_t>> rays_of_tile)
      : ranks_(std::move(transport)),
        lived_(lived),
        frame_(frame),
        plan_(plan),
        worker_(frame, plan, costs, rays_of_tile, static_cast<std::uint32_t>(ranks_.rank()),
                static_cast<std::size_t>(ranks_.size()), lived.depth) {}

  // The list is there.
  void begin() {
    odprt::RankTable table{&ranks_, {}};
    for (int r = 0; r <= ranks_.size(); ++r) table.first.push_back(static_cast<std::size_t>(r));
    std::vector<std::size_t> owner(static_cast<std::size_t>(ranks_.size()));
    for (std::size_t p = 0; p < owner.size(); ++p) owner[p] = p;
    std::vector<std::vector<bool>> direct(1, std::vector<bool>(owner.size(), false));
    outboxes_.resize(1);
    outboxes_.front().push_back(std::make_unique<odprt::Outbox>(plan_.outbox));
    shares_.emplace(odprt::of_rank(frame_.tiles, table));
    exchange_.emplace(plan_, table, std::move(owner), std::move(direct), outboxes_, *shares_);
    const odprt::RaysKnown known{
        .first_part = static_cast<std::uint32_t>(ranks_.rank()),
        .n_parts = 1,
        .n_all_parts = static_cast<std::uint32_t>(ranks_.size()),
        .n_slices = plan_.n_slices,
        .ray_fields = plan_.outbox.ray_fields,
        .max_depth = static_cast<std::uint32_t>(lived_.depth),
        .first_pixel = 0,
        .n_pixels = static_cast<std::size_t>(lived_.width) * static_cast<std::size_t>(lived_.height)};
    post_.emplace(table, 1u, known, plan_, *exchange_, *shares_,
                  [n = frame_.n_tiles](layout::u32 tile) { return tile < n; });
  }

  bool has_begun() const { return post_.has_value(); }
  void look() {
    if (!post_->is_over()) post_->step();
  }
  // Work that begins now.
  std::optional<double> go_on() {
    if (worker_.is_at_work() || post_->is_over()) return std::nullopt;
    return worker_.begin_turn(*exchange_, *shares_);
  }
  void end_turn() { worker_.end_turn(*exchange_); }
  bool is_over() const { return post_ && post_->is_over() && !worker_.is_at_work(); }

  const PretendWorker& worker() const { return worker_; }
  const transport::Counters& counters() const { return ranks_.counters(); }

 private:
  transport::Ranks ranks_;
  const LivedFrame& lived_;
  const DividedFrame& frame_;
  const odprt::Plan& plan_;
  PretendWorker worker_;
  std::vector<std::vector<std::unique_ptr<odprt::Outbox>>> outboxes_;
  std::optional<odprt::Shares> shares_;
  std::optional<odprt::Exchange> exchange_;
  std::optional<odprt::Post> post_;
};

class OdprtSimulation {
 public:
  OdprtSimulation(const LivedFrame& lived, const DividedFrame& frame, const OdprtCosts& costs,
                  const RanksSetting& setting)
      : frame_(frame),
        costs_(costs),
        setting_(setting),
        look_(std::max(setting.look - kShorterNap, 1e-6)),
        plan_(plan_of(lived, frame.n_tiles, setting.ranks)),
        rays_of_tile_(frame.n_tiles),
        network_(setting.ranks, link_of(setting), setting.seed),
        cores_(setting.speed) {
    for (std::size_t i = 0; i < frame.traffic.first.size(); ++i)
      rays_of_tile_[frame.tile_of_first[i]].push_back(frame.traffic.first[i]);
    const HostCosts of_message{.send = setting.messages.send, .take = setting.messages.take};
    std::mt19937_64 random(setting.seed);
    for (int r = 0; r < setting.ranks; ++r) {
      parts_.push_back(std::make_unique<PretendPart>(std::make_unique<SimHost>(network_, r, of_message),
                                                     lived, frame, plan_, costs, rays_of_tile_));
      const double hears = r == 0 ? 0 : setting.messages.latency + setting.delay + setting.messages.send * r;
      looks_.push({hears + (r == 0 ? 0 : look_ * static_cast<double>(random() >> 11) * 0x1p-53), r});
    }
  }

  SimulatedOdprt run() {
    while (!std::ranges::all_of(parts_, &PretendPart::is_over)) step();
    SimulatedOdprt outcome;
    outcome.seconds = network_.now() + seconds_of_sums() + costs_.end_seconds / setting_.speed(1);
    for (const auto& part : parts_)
      outcome.busy += part->worker().busy(), outcome.rays_sent += part->worker().sent();
    const transport::Counters& counters = parts_.front()->counters();
    outcome.messages = counters.sent + counters.received;
    outcome.bytes = counters.bytes_sent + counters.bytes_received;
    for (std::size_t r = 1; r < frame_.pixels_of.size(); ++r) {
      const double sums = kBytesOfPixel * static_cast<double>(frame_.pixels_of[r]);
      outcome.bytes += static_cast<std::uint64_t>(sums);
      outcome.messages += static_cast<std::uint64_t>(sums / kBytesOfMessage) + 1;
    }
    outcome.events = n_events_;
    return outcome;
  }

 private:
  void step() {
    const double look = looks_.empty() ? kNeverYet : looks_.top().first;
    const double next = std::min(cores_.next_end(), look);
    if (next == kNeverYet || network_.now() > kMostSeconds)
      throw Error(ErrorCode::internal, "the simulated ranks of ODPRT stand still");
    ++n_events_;
    cores_.advance(std::max(next, network_.now()));
    network_.advance(next);
    while (const auto r = cores_.take_ended()) {
      part(*r).end_turn();
      go_on(*r);
    }
    while (!looks_.empty() && looks_.top().first <= network_.now()) {
      const int r = looks_.top().second;
      looks_.pop();
      if (!part(r).has_begun()) part(r).begin();
      part(r).look();
      go_on(r);
      if (!part(r).is_over()) looks_.push({network_.free_at(r) + look_, r});
    }
  }

  PretendPart& part(int r) { return *parts_[static_cast<std::size_t>(r)]; }

  void go_on(int r) {
    if (const auto work = part(r).go_on()) cores_.start(r, *work);
  }

  // Until what others have of the picture is with rank 0, which takes it as it takes tiles' sums.
  double seconds_of_sums() const {
    if (setting_.ranks == 1) return 0;
    double bytes = 0;
    for (std::size_t r = 1; r < frame_.pixels_of.size(); ++r)
      bytes += kBytesOfPixel * static_cast<double>(frame_.pixels_of[r]);
    const transport::Link link = link_of(setting_);
    return link.latency + link.of_bytes(kLongBytes) + setting_.look + bytes / link.bandwidth;
  }

  static constexpr double kMostSeconds = 1e4;
  using At = std::pair<double, int>;

  const DividedFrame& frame_;
  const OdprtCosts& costs_;
  const RanksSetting& setting_;
  double look_;
  odprt::Plan plan_;
  std::vector<std::vector<std::uint32_t>> rays_of_tile_;
  transport::Network network_;
  SharedCores cores_;
  std::vector<std::unique_ptr<PretendPart>> parts_;
  std::priority_queue<At, std::vector<At>, std::greater<>> looks_;
  std::size_t n_events_ = 0;
};

}  // namespace

SimulatedOdprt simulate_odprt(const LivedFrame& lived, const DividedFrame& frame, const OdprtCosts& costs,
                              const RanksSetting& setting) {
  return OdprtSimulation(lived, frame, costs, setting).run();
}

}  // namespace kdray::bench
