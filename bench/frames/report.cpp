#include <fmt/format.h>

#include "bench/embree/embree.h"
#include "bench/frames/bench.h"
#include "bench/measure/short_name.h"

namespace kdray::bench {

namespace {

Json json_of(const EmbreeFrame& e) {
  return {{"name", e.name}, {"seconds", json_of(e.seconds)}, {"rays", e.n_rays}};
}

Json optional_json(const std::optional<Spread>& spread) {
  return spread ? json_of(*spread) : Json();
}

Json json_of(const FrameResult& f) {
  Json json = {{"scene", f.scene},
               {"primitives", json_of(f.n_primitives)},
               {"cores", f.cores},
               {"device", f.device},
               {"seconds", json_of(f.seconds)},
               {"mrays_per_s", json_of(mrays_per_s(f.n_rays(), f.seconds))},
               {"stages", Json::object()},
               {"rays", Json::object()},
               {"povray_seconds", optional_json(f.povray_seconds)},
               {"povray_ratio", Json()},
               {"embree", Json::array()},
               {"embree_ratio", Json()}};
  for (const auto& [stage, seconds] : f.stages) json["stages"][stage] = json_of(seconds);
  for (const auto& [kind, n] : f.rays) json["rays"][kind] = n;
  if (f.povray_seconds) json["povray_ratio"] = f.povray_seconds->median / f.seconds.median;
  for (const EmbreeFrame& e : f.embree) json["embree"].push_back(json_of(e));
  if (const EmbreeFrame* const e = f.fastest_embree())
    json["embree_ratio"] = e->seconds.median / f.seconds.median;
  return json;
}

std::string in_millions(std::uint64_t n) {
  return fmt::format("{:.2f}", static_cast<double>(n) * 1e-6);
}

}  // namespace

std::string table_of(const FrameResult& f) {
  const auto rays = [&](const char* kind) { return in_millions(f.rays.at(kind)); };
  std::string out = fmt::format(
      "{}: {:.4f} s ({:.4f} to {:.4f}), {:.1f} Mrays/s; {} core{}\n"
      "  rays (M): primary {}, shadow {}, reflected {}, refracted {}, total {}\n  stages (device s):",
      short_name(f.scene), f.seconds.median, f.seconds.min, f.seconds.max,
      mrays_per_s(f.n_rays(), f.seconds).median, f.cores, f.cores == 1 ? "" : "s", rays("primary"),
      rays("shadow"), rays("reflected"), rays("refracted"), rays("total"));
  for (const auto& [stage, seconds] : f.stages) out += fmt::format(" {} {:.4f}", stage, seconds.median);
  if (f.povray_seconds)
    out += fmt::format("\n  POV-Ray: {:.3f} s, {:.1f} times as long", f.povray_seconds->median,
                       f.povray_seconds->median / f.seconds.median);
  for (const EmbreeFrame& e : f.embree)
    out += fmt::format("\n  {}: {:.4f} s ({:.4f} to {:.4f}), {:.2f} times as long; {} M rays", e.name,
                       e.seconds.median, e.seconds.min, e.seconds.max, e.seconds.median / f.seconds.median,
                       in_millions(e.n_rays));
  return out + "\n";
}

Json json_of(std::span<const FrameResult> frames, const FramesOptions& options) {
  const std::string embree = options.embree ? embree_versions() : "";
  Json json = {{"command", "bench frames"},
               {"embree", embree.empty() ? Json() : Json(embree)},
               {"size", {options.width, options.height}},
               {"depth", options.depth},
               {"repeat", options.repeat},
               {"frames", Json::array()}};
  for (const FrameResult& f : frames) json["frames"].push_back(json_of(f));
  return json;
}

}  // namespace kdray::bench
