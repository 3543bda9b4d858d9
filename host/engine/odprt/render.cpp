#include "engine/odprt/render.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <numeric>

#include "accel/flatten/instance_openings.h"
#include "base/error.h"
#include "base/timer.h"
#include "engine/odprt/assign.h"
#include "engine/odprt/executor.h"
#include "engine/odprt/rank_table.h"

namespace kdray::odprt {

namespace {

constexpr std::uint32_t kShrink = 8;  // pixels of the frame to one of the probe's, along each side
constexpr std::uint32_t kTile = 16;

// The same view in fewer pixels: each looks along the middle of those that it stands for.
layout::Frame small_frame(layout::Frame frame) {
  frame.width = (frame.width + kShrink - 1) / kShrink;
  frame.height = (frame.height + kShrink - 1) / kShrink;
  frame.crop_x /= kShrink;
  frame.crop_y /= kShrink;
  frame.x_scale *= kShrink;
  frame.y_scale *= kShrink;
  frame.n_samples = 1;
  frame.tile_width = frame.tile_height = kTile;
  frame.n_tiles_x = (frame.width + kTile - 1) / kTile;
  frame.n_tiles = frame.n_tiles_x * ((frame.height + kTile - 1) / kTile);
  return frame;
}

// A small frame of the whole scene on one queue, which counts how many rays come to each subtree: what the
// subtrees' costs are estimated by before the scene is divided. `whole` is the scene in one part.
std::vector<SubtreeUse> probe_costs(const Request& request, const Division& whole, const Cut& cut) {
  Request probe = request;
  probe.queues.resize(1);
  probe.table = alone(1);
  probe.n_slices = (request.n_slices + 3) / 4;  // its tiles are few
  probe.frame = small_frame(request.frame);
  probe.adaptive_target = 0;
  probe.census_every = 1;
  probe.device_memory = 0;
  probe.timeline = nullptr;
  probe.fault_injector = nullptr;
  probe.progress = {};
  probe.checkpoint = nullptr;
  return render_frame(probe, provide(probe, 0), whole, cut).visits;
}

constexpr std::size_t kSubtreesPerPart = 16, kLeastSubtrees = 64, kMostSubtrees = 512, kFewPerPart = 4;
// A queue may hold so much more than an equal share of the geometry. Less is replicated where primitives in
// several parts would take it beyond that.
constexpr double kMostSpare = 0.2;
constexpr double kUnbalanced = 1.05;  // the busiest queue against the mean, from which on subtrees are moved
constexpr std::uint32_t kCensusEvery = 16;
constexpr double kHitCost = 20;  // of what a hit is shaded for; a node costs 1

std::size_t subtrees_for(std::size_t n_parts) {
  return std::clamp(kSubtreesPerPart * n_parts, kLeastSubtrees,
                    std::max(kMostSubtrees, kFewPerPart * n_parts));
}

// With a limit nothing is held twice. Where all parts stay, they keep to what has been provided for; where
// they come and go, their size is checked.
DivideOptions options_for(const Provision& provision, const Request& request) {
  if (request.device_memory == 0) return {provision.n_parts, kSpare, kReplicated};
  return {provision.n_parts,
          provision.streamed ? kSpare : std::min(kSpare, (kMostOfEqualShare - 1) / provision.n_parts), 0};
}

}  // namespace

DividedScene::DividedScene(flatten::FlatScene flat, flatten::WideForm wide,
                           std::shared_ptr<transport::Together> all)
    : flat_(std::move(flat)), wide_(std::move(wide)), all_(std::move(all)) {
  flatten::close_instances(flat_, wide_);  // an instance is in one part
  flat_.nodes = {};                        // parts have no binary tree
  flat_.refs = {};
}

void DividedScene::light(const flatten::FlatScene& seen) {
  const auto light = [&seen](flatten::FlatScene& flat) {
    flat.lights = seen.lights, flat.sky = seen.sky, flat.sky_colors = seen.sky_colors;
  };
  light(flat_);
  if (!division_) return;
  for (Part& part : division_->parts) light(part.flat);
}

void DividedScene::cut_for(std::uint32_t n_parts) {
  cut_into(subtrees_for(n_parts));
}

void DividedScene::cut_into(std::size_t n) {
  if (n <= n_asked_) return;
  cut_ = odprt::cut(flat_, wide_, n);
  n_asked_ = n;
  costs_.clear();
  for (const Subtree& subtree : cut_.subtrees) costs_.push_back(subtree.cost);
  measured_ = false;
  division_.reset();
}

// Replicates less than asked for where primitives in several parts take much.
void DividedScene::divide_by(const DivideOptions& options) {
  if (division_ && divided_by_ == options) return;
  const double most = (1.0 / options.n_parts + kMostSpare) * static_cast<double>(geometry_bytes());
  DivideOptions o = options;
  division_ = divide(flat_, wide_, cut_, costs_, o);
  while (o.replicated > 0 && static_cast<double>(largest_bytes(*division_)) > most) {
    o.replicated = std::max(o.replicated - 0.04, 0.0);
    division_ = divide(flat_, wide_, cut_, costs_, o);
  }
  divided_by_ = options;
}

void DividedScene::measure_costs(const Request& request) {
  if (request.balance == Balance::sah || measured_) return;
  const Division whole = divide(flat_, wide_, cut_, costs_, {});
  weigh(probe_costs(request, whole, cut_));
}

// A subtree costs as much as rays came to it, times what one is expected to cost there, and what its hits are
// shaded for.
double DividedScene::cost_of(const SubtreeUse& use, std::size_t subtree) const {
  return static_cast<double>(use.visits) * cut_.subtrees[subtree].visit +
         kHitCost * static_cast<double>(use.hits);
}

void DividedScene::weigh(std::span<const SubtreeUse> visits) {
  double sum = 0;
  std::vector<double> costs(cut_.subtrees.size());
  for (std::size_t i = 0; i < costs.size(); ++i) sum += costs[i] = cost_of(visits[i], i);
  if (sum == 0) return;  // no ray met anything
  costs_ = std::move(costs);
  measured_ = true;
  division_.reset();
}

// Learns from the last frame: from the visits, and from how long each queue took for its part's.
void DividedScene::learn(const Result& result) {
  if (result.visits.size() != costs_.size() || !division_) return;
  std::vector<double> costs(costs_.size()), of_part(division_->parts.size());
  for (std::size_t i = 0; i < costs.size(); ++i) {
    costs[i] = cost_of(result.visits[i], i);
    if (division_->part_of[i] != kEveryPart) of_part[division_->part_of[i]] += costs[i];
  }
  double busiest = 0, all = 0;
  for (const QueueReport& queue : result.queues) {
    busiest = std::max(busiest, queue.busy_seconds);
    all += queue.busy_seconds;
  }
  // It isn't worth its while where queues are about as busy as each other.
  if (all == 0 || busiest * static_cast<double>(result.queues.size()) < kUnbalanced * all) return;
  // Seconds are turned into units of the counted costs, which are those of what every part holds too.
  const double seconds_of_cost = all / std::max(std::accumulate(of_part.begin(), of_part.end(), 0.0), 1.0);
  for (std::size_t i = 0; i < costs.size(); ++i) {
    const std::uint32_t part = division_->part_of[i];
    if (part != kEveryPart && of_part[part] > 0)
      costs[i] *= result.queues[part].busy_seconds / of_part[part] / seconds_of_cost;
  }
  costs_ = std::move(costs);
  division_.reset();
}

// Parts are of unequal size: where one turns out too large, there are to be more of them.
Provision DividedScene::divide_for(const Request& request) {
  for (std::uint32_t least_parts = 0;;) {
    Provision provision = provide(request, geometry_bytes(), least_parts);
    cut_for(provision.n_parts);
    if (!provision.streamed) measure_costs(request);
    divide_by(options_for(provision, request));
    if (fits(provision, *division_, request)) return provision;
    least_parts = std::min<std::uint32_t>(provision.n_parts + provision.n_parts / 4 + 1, kMostParts);
  }
}

// Rank 0 says who holds what, since it alone has measured; each keeps its own parts.
Provision DividedScene::divide_with_ranks(const Request& request) {
  Provision provision = provide(request, geometry_bytes());
  cut_for(provision.n_parts);
  if (request.table.leads()) {
    Request probe = request;
    probe.checkpoint = nullptr;
    measure_costs(probe);
    divide_by(options_for(provision, request));
  }
  std::vector<std::uint32_t> part_of = share_division(
      *request.table.ranks, request.table.leads() ? division_->part_of : std::vector<std::uint32_t>());
  if (!request.table.leads()) {
    check_division(part_of, provision.n_parts);
    if (!division_ || division_->part_of != part_of)
      division_ = divide(flat_, wide_, cut_, std::move(part_of), provision.n_parts);
    divided_by_ = {};
  }
  for (std::uint32_t part = 0; part < division_->parts.size(); ++part)
    if (!request.table.is_own(part)) division_->parts[part] = {};
  return provision;
}

// Costs are the tree's, since a probe would need the whole scene.
Provision DividedScene::divide_what_is_held(const Request& request) {
  Provision provision = provide(request, 0);
  cut_into(subtrees_of_rank(subtrees_for(provision.n_parts), request.table));
  if (!division_) {
    held_bytes_ = all_->sum(odprt::geometry_bytes(flat_, wide_));
    division_ = divide_partition(flat_, wide_, cut_, costs_, request.table, *all_);
  }
  return provision;
}

// Of rank 0's division: all have the same subtrees.
void DividedScene::check_division(std::span<const std::uint32_t> part_of, std::uint32_t n_parts) const {
  const bool fits =
      std::ranges::all_of(part_of, [&](std::uint32_t part) { return part < n_parts || part == kEveryPart; });
  if (!fits || part_of.size() != cut_.subtrees.size())
    throw Error(ErrorCode::internal, "rank 0 has divided the scene otherwise than this rank could");
}

Provision DividedScene::divide_as_asked(const Request& request) {
  if (all_) return divide_what_is_held(request);
  cut_for(static_cast<std::uint32_t>(request.table.n_queues()));
  return request.table.ranks ? divide_with_ranks(request) : divide_for(request);
}

Result DividedScene::render_once(const Request& request) {
  const Timer timer;
  const Provision provision = divide_as_asked(request);
  const double seconds = timer.seconds();
  Result result = render_frame(request, provision, *division_, cut_);
  result.divide_seconds = seconds;
  return result;
}

Result DividedScene::render(const Request& asked) {
  Request request = asked;
  if (request.table.n_queues() > kMostParts)
    throw Error(ErrorCode::usage,
                fmt::format("odprt takes {} queues at most, of all ranks together; take fewer (--queues)",
                            kMostParts));
  const bool learns = request.balance == Balance::dynamic && request.table.ranks == nullptr;
  if (learns) request.census_every = kCensusEvery;
  std::vector<Quarantined> quarantined;
  for (;;) {
    try {
      Result result = render_once(request);
      result.quarantined = std::move(quarantined);
      if (learns) learn(result);
      return result;
    } catch (const QueueFailures& e) {
      if (request.table.ranks) throw Error(e.failures.front().error);
      // The last first, so that the places of the others stay.
      for (auto failure = e.failures.rbegin(); failure != e.failures.rend(); ++failure) {
        quarantined.push_back({request.queues[failure->queue].number, failure->error.what()});
        request.queues.erase(request.queues.begin() + static_cast<std::ptrdiff_t>(failure->queue));
      }
      request.table = alone(request.queues.size());
      if (request.queues.empty()) throw Error(e.failures.front().error);
    }
  }
}

}  // namespace kdray::odprt
