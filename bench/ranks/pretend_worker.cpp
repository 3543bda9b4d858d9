#include "bench/ranks/pretend_worker.h"

#include <algorithm>
#include <array>
#include <bit>

#include "layout/rays.layout.h"

namespace kdray::bench {

namespace {

constexpr std::size_t kBatch = 512;     // as odprt/plan.cpp has it
constexpr std::uint32_t kEyeWaves = 4;  // one wave of so many is of eye rays (odprt/worker.cpp)

float word(std::uint32_t value) {
  return std::bit_cast<float>(value);
}

}  // namespace

PretendWorker::PretendWorker(const DividedFrame& frame, const odprt::Plan& plan, const OdprtCosts& costs,
                             std::span<const std::vector<std::uint32_t>> rays_of_tile, std::uint32_t part,
                             std::size_t n_parts, int max_depth)
    : frame_(frame),
      plan_(plan),
      costs_(costs),
      rays_of_tile_(rays_of_tile),
      part_(part),
      pools_(static_cast<std::size_t>(max_depth) + 1),
      out_(n_parts, odprt::Mail(plan.n_slices, plan.outbox.ray_fields)) {
  state_.part = part;
}

std::uint32_t PretendWorker::level_of(std::uint32_t life) const {
  return frame_.is_shadow[life] ? 0 : frame_.traffic.journeys[life].depth;
}

void PretendWorker::take_in(odprt::Mail& mail) {
  const auto take = [&](odprt::RayPile& pile) {
    const std::span<const float> words = pile.last(pile.size());
    for (std::size_t i = 0; i < pile.size(); ++i) {
      const Place ray{std::bit_cast<std::uint32_t>(words[i * pile.n_fields()]),
                      std::bit_cast<std::int32_t>(words[i * pile.n_fields() + 1])};
      pools_[level_of(ray.life)].push_back(ray);
      seconds_ += costs_.of_sent_ray / 2;
    }
    pile.drop(pile.size());
  };
  for (std::size_t s = 0; s < mail.rays.size(); ++s) take(mail.rays[s]), take(mail.shadow_rays[s]);
  mail.n = 0;
}

// As BandRun::take_entries() and Worker::launch_tiles() have it.
void PretendWorker::take_entries(odprt::Shares& shares) {
  const std::size_t of_tile = std::max<std::size_t>(rays_of_tile_.front().size(), 1);
  const std::size_t launch_tiles = plan_.n_slices * plan_.n_waves * kBatch / kEyeWaves / of_tile;
  const std::size_t n = std::min(launch_tiles, shares.left() / (4 * shares.n_queues()));
  const std::size_t wanted = std::max<std::size_t>(n, plan_.n_slices),
                    has = tiles_.size() + (eye_rays_.empty() ? 0 : 1);
  if (has >= wanted) return;
  const odprt::Shares::Entries taken = shares.take(0, wanted - has);
  tiles_.insert(tiles_.begin(), taken.rbegin(), taken.rend());
}

bool PretendWorker::may_go(std::uint32_t level, std::size_t n, const layout::Grant& grant) const {
  return traffic_.made[level] + n <= grant.rays[level] + traffic_.ended[level];
}

// Whether all that comes of a ray here finds its place, whatever it is.
bool PretendWorker::has_room_for(const Place& ray, const layout::Grant& grant) const {
  if (n_out_ + plan_.least.back() + 1 > plan_.outbox.rays ||
      n_shadow_out_ + plan_.least.front() + 1 > plan_.outbox.shadow)
    return false;
  const std::uint32_t level = level_of(ray.life);
  if (level == 0) return true;
  const bool deeper = level + 1 < pools_.size();
  return may_go(0, plan_.least.front(), grant) &&
         (!deeper || may_go(level + 1, plan_.least[level + 1], grant));
}

void PretendWorker::send(const Place& ray, std::uint32_t to) {
  odprt::Mail& mail = out_[to];
  const std::uint32_t level = level_of(ray.life);
  ++n_sent_;
  seconds_ += costs_.of_sent_ray / 2;
  if (level == 0) {
    std::array<float, KDRAY_TRAVEL_SHADOW_FIELDS> words{};
    words[0] = word(ray.life), words[1] = word(static_cast<std::uint32_t>(ray.hop));
    mail.shadow_rays.front().put_all(words);
    ++n_shadow_out_;
  } else {
    std::vector<float> words(plan_.outbox.ray_fields);
    words[0] = word(ray.life), words[1] = word(static_cast<std::uint32_t>(ray.hop));
    words[KDRAY_RAY_FINDER] = word(KDRAY_FINDER(KDRAY_NO_PART, level));
    mail.rays.front().put_all(words);
    mail.deepest = std::max(mail.deepest, level);
    ++n_out_;
  }
  ++mail.n;
}

// A ray that has come to its end leads to others.
void PretendWorker::end(std::uint32_t life) {
  for (const std::uint32_t next : frame_.traffic.journeys[life].next) begin(next, 0);
}

// A ray that is made here. One that is a shadow ray is traced at once, and counts only if it goes on.
void PretendWorker::begin(std::uint32_t life, std::int32_t hop) {
  const Journey& journey = frame_.traffic.journeys[life];
  const std::uint32_t level = level_of(life);
  if (level > 0) {
    ++traffic_.made[level];
    if (hop == 0 && journey.hops.front().queue != part_) hop = -1;
    pools_[level].push_back({life, hop});
    return;
  }
  const bool is_here = journey.hops.front().queue == part_;
  if (is_here) {
    ++traffic_.n_traced;
    seconds_ += journey.hops.front().seconds;
    if (journey.hops.size() == 1) return;
  }
  ++traffic_.made[0];
  send({life, is_here ? 1 : 0}, journey.hops[is_here ? 1 : 0].queue);
}

void PretendWorker::trace(const Place& ray) {
  const Journey& journey = frame_.traffic.journeys[ray.life];
  ++traffic_.n_traced;
  if (ray.hop >= 0) seconds_ += journey.hops[static_cast<std::size_t>(ray.hop)].seconds;
  const auto next = static_cast<std::size_t>(ray.hop + 1);
  if (next < journey.hops.size())
    return send({ray.life, static_cast<std::int32_t>(next)}, journey.hops[next].queue);
  ++traffic_.ended[level_of(ray.life)];
  end(ray.life);
}

// Whether some were made.
bool PretendWorker::make_eye_rays(const layout::Grant& grant, std::size_t most) {
  std::size_t n = 0;
  for (; n < most && may_go(1, 1, grant); ++n) {
    if (eye_rays_.empty()) {
      if (tiles_.empty()) break;
      const std::vector<std::uint32_t>& rays = rays_of_tile_[tiles_.back()];
      eye_rays_.assign(rays.rbegin(), rays.rend());
      tiles_.pop_back();
    }
    begin(eye_rays_.back(), 0);
    eye_rays_.pop_back();
  }
  return n > 0;
}

// Waves until there is nothing more to do, or nothing that may be done. Returns the seconds.
double PretendWorker::launch(const layout::Grant& grant) {
  for (traffic_.n_waves = 0; traffic_.n_waves < plan_.n_waves;) {
    bool did = false;
    for (std::size_t level = 0; level < pools_.size() && !did; ++level) {
      // Shadow rays first, then the deepest.
      std::vector<Place>& pool = pools_[level == 0 ? 0 : pools_.size() - level];
      for (std::size_t n = 0; n < kBatch && !pool.empty() && has_room_for(pool.back(), grant); ++n) {
        const Place ray = pool.back();
        pool.pop_back();
        trace(ray);
        did = true;
      }
    }
    if (!did) did = make_eye_rays(grant, kBatch);
    if (!did) break;
    ++traffic_.n_waves;
  }
  return seconds_;
}

std::optional<double> PretendWorker::begin_turn(odprt::Exchange& exchange, odprt::Shares& shares) {
  turn_ = exchange.try_turn(0, state_);
  if (!turn_) return std::nullopt;
  seconds_ = 0;
  traffic_ = {};
  n_out_ = n_shadow_out_ = 0;
  odprt::Mail came(plan_.n_slices, plan_.outbox.ray_fields);
  exchange.take_mail(part_, came);
  take_in(came);
  if (turn_->outbox) {
    take_entries(shares);
    launch(turn_->grants.front());
  }
  busy_ += seconds_;
  state_.has_tiles = !tiles_.empty() || !eye_rays_.empty();
  state_.has_rays = std::ranges::any_of(pools_, [](const auto& pool) { return !pool.empty(); });
  state_.progressed = traffic_.n_waves > 0;
  return seconds_;
}

void PretendWorker::end_turn(odprt::Exchange& exchange) {
  const odprt::Turn turn = *std::exchange(turn_, std::nullopt);
  exchange.end_turn(0, turn, {&traffic_, 1}, state_, out_);
}

}  // namespace kdray::bench
