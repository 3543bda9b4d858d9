#include "bench/race/kdray_contestants.h"

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
  traced.seconds = renderer.statistics().seconds.trace;
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

Contestant kdray_contestant(const std::shared_ptr<Renderer>& renderer, const std::string& traversal) {
  return {Family::kdray, traversal, {{"", [renderer, t = traversal_of(traversal)](const RayClass& c) {
                                        return trace(*renderer, c, t);
                                      }}}};
}

}  // namespace kdray::bench
