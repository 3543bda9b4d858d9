#include "bench/modes/traffic.h"

#include <algorithm>

namespace kdray::bench {

namespace {

// The way of one ray.
class Way {
 public:
  Way(std::uint32_t start, double seconds_of_cost, std::vector<Hop>& hops)
      : seconds_of_cost_(seconds_of_cost), hops_(hops) {
    hops_.push_back({start, 0});
  }

  void visit(const Visit& v) {
    if (v.owner == kDirectory) {
      hops_.back().seconds += v.cost * seconds_of_cost_;
    } else {
      ask(v.owner).seconds += v.cost * seconds_of_cost_;
    }
  }

  // Asks no one after this queue.
  void end_with(std::uint32_t queue) {
    while (hops_.back().queue != queue) hops_.pop_back();
  }

  void go_to(std::uint32_t queue) {
    if (hops_.back().queue != queue) hops_.push_back({queue, 0});
  }

 private:
  // The first stop is only asked when its turn comes.
  Hop& ask(std::uint32_t queue) {
    const auto asked = std::find_if(hops_.begin() + (start_is_asked_ ? 0 : 1), hops_.end(),
                                    [&](const Hop& hop) { return hop.queue == queue; });
    if (asked != hops_.end()) return *asked;
    if (hops_.size() == 1 && hops_.front().queue == queue) {
      start_is_asked_ = true;
    } else {
      hops_.push_back({queue, 0});
    }
    return hops_.back();
  }

  double seconds_of_cost_;
  std::vector<Hop>& hops_;
  bool start_is_asked_ = false;
};

// The queue that finds the hit, to which the walk comes last; kDirectory: all hold it.
std::uint32_t finder(std::span<const Visit> path) {
  return path.empty() ? kDirectory : path.back().owner;
}

// The queue that a ray enters first; kDirectory: none.
std::uint32_t first_owner(std::span<const Visit> path) {
  const auto first =
      std::find_if(path.begin(), path.end(), [](const Visit& v) { return v.owner != kDirectory; });
  return first != path.end() ? first->owner : kDirectory;
}

}  // namespace

Traffic make_traffic(std::span<const LifeRay> lives, const Paths& paths, std::uint32_t n_queues,
                     const Rates& rates, double rays_per_journey) {
  // Where an eye ray is made: by the queue that it enters first, if any.
  const auto maker = [&](std::uint32_t i) {
    const std::uint32_t first = first_owner(paths.of(i));
    return first != kDirectory ? first : i % n_queues;
  };
  Traffic traffic;
  traffic.rays_per_journey = rays_per_journey;
  traffic.journeys.resize(lives.size());
  for (std::uint32_t i = 0; i < lives.size(); ++i) {
    const LifeRay& life = lives[i];
    Journey& journey = traffic.journeys[i];
    journey.depth = life.depth;
    const bool from_eye = life.parent == kNoParent;
    (from_eye ? traffic.first : traffic.journeys[life.parent].next).push_back(i);
    Way way(from_eye ? maker(i) : traffic.journeys[life.parent].hops.back().queue,
            rays_per_journey * rates.seconds_of_cost, journey.hops);
    for (const Visit& v : paths.of(i)) way.visit(v);
    if (const std::uint32_t found_by = finder(paths.of(i)); life.hit && found_by != kDirectory)
      life.kind == LifeKind::shadow ? way.end_with(found_by) : way.go_to(found_by);
    if (is_shaded(life)) journey.hops.back().seconds += rays_per_journey * rates.seconds_of_shade;
  }
  return traffic;
}

}  // namespace kdray::bench
