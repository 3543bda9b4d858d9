#include "bench/race/kdray_contestants.h"

#include <array>

#include "api/names.h"
#include "base/error.h"

namespace kdray::bench {

namespace {

constexpr std::array<std::string_view, 5> kNames = {"binary", "wide", "packet", "batch", "auto"};

}  // namespace

std::span<const std::string_view> traversal_names() {
  return kNames;
}

Traversal traversal_of(std::string_view name) {
  for (const Traversal t :
       {Traversal::binary, Traversal::wide, Traversal::packet, Traversal::batch, Traversal::automatic})
    if (api::name_of(t) == name) return t;
  throw Error(ErrorCode::usage, "there is no traversal '" + std::string(name) + "'");
}

Contestant kdray_contestant(const std::shared_ptr<Renderer>& renderer, const std::string& traversal) {
  const auto trace = [renderer, t = traversal_of(traversal)](const RayClass& c) {
    std::vector<Hit> hits = renderer->trace(c.rays, c.any_hit, 1, t);
    return Traced{renderer->statistics().seconds.trace, std::move(hits)};
  };
  return {Family::kdray, traversal, {{"", trace}}};
}

}  // namespace kdray::bench
