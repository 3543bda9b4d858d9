#include "bench/kdray_contestants.h"

#include <array>
#include <nlohmann/json.hpp>

#include "base/error.h"

namespace kdray::bench {

namespace {

constexpr std::array<std::string_view, 5> kNames = {"binary", "wide", "packet", "batch", "auto"};
constexpr std::array<Traversal, 5> kTraversals = {Traversal::binary, Traversal::wide, Traversal::packet,
                                                  Traversal::batch, Traversal::automatic};

Traced trace(Renderer& renderer, const RayClass& c, Traversal traversal) {
  Traced traced;
  traced.hits = renderer.trace(c.rays, c.any_hit, 1, traversal);
  traced.seconds = nlohmann::json::parse(renderer.statistics()).at("seconds").at("trace");
  return traced;
}

}  // namespace

std::span<const std::string_view> traversal_names() {
  return kNames;
}

Traversal traversal_of(std::string_view name) {
  for (std::size_t i = 0; i < kNames.size(); ++i)
    if (kNames[i] == name) return kTraversals[i];
  throw Error(ErrorCode::usage, "there is no traversal '" + std::string(name) + "'");
}

std::vector<Contestant> kdray_contestants(const std::shared_ptr<Renderer>& renderer,
                                          std::span<const std::string> traversals) {
  std::vector<Contestant> contestants;
  for (const std::string& name : traversals)
    contestants.push_back({Family::kdray, name, {{"", [renderer, t = traversal_of(name)](const RayClass& c) {
                                                    return trace(*renderer, c, t);
                                                  }}}});
  return contestants;
}

}  // namespace kdray::bench
