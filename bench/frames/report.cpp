#include <fmt/format.h>

#include "bench/embree/embree.h"
#include "bench/frames/bench.h"

namespace kdray::bench {

namespace {

Json json_of(const EmbreeFrame& e) {
  return {{"name", e.name}, {"seconds", json_of(e.seconds)}, {"rays", e.n_rays}};
}

Json json_of(const FrameResult& f) {
  Json json = {{"scene", f.scene},
               {"primitives", json_of(f.n_primitives)},
               {"cores", f.machine.cores},
               {"device", f.machine.device},
               {"seconds", json_of(f.seconds)},
               {"mrays_per_s", json_of(mrays_per_s(f.n_rays(), f.seconds))},
               {"stages", Json::object()},
               {"rays", f.rays},
               {"povray_seconds", json_if(f.povray_seconds)},
               {"povray_ratio", Json()},
               {"embree", json_list(f.embree, [](const EmbreeFrame& e) { return json_of(e); })},
               {"embree_ratio", Json()}};
  for (const auto& [stage, seconds] : f.stages) json["stages"][stage] = json_of(seconds);
  if (f.povray_seconds) json["povray_ratio"] = f.povray_seconds->median / f.seconds.median;
  if (const EmbreeFrame* const e = f.fastest_embree())
    json["embree_ratio"] = e->seconds.median / f.seconds.median;
  return json;
}

}  // namespace

std::string table_of(const FrameResult& f) {
  const auto rays = [&](const char* kind) { return millions(f.rays.at(kind)); };
  std::string out = fmt::format(
      "{}: {:.4f} s ({:.4f} to {:.4f}), {:.1f} Mrays/s; {}\n"
      "  rays (M): primary {:.2f}, shadow {:.2f}, reflected {:.2f}, refracted {:.2f}, total {:.2f}\n  stages "
      "(device s):",
      short_name(f.scene), f.seconds.median, f.seconds.min, f.seconds.max,
      mrays_per_s(f.n_rays(), f.seconds).median, counted(f.machine.cores, "core"), rays("primary"),
      rays("shadow"), rays("reflected"), rays("refracted"), rays("total"));
  for (const auto& [stage, seconds] : f.stages) out += fmt::format(" {} {:.4f}", stage, seconds.median);
  if (f.povray_seconds)
    out += fmt::format("\n  POV-Ray: {:.3f} s, {:.1f} times as long", f.povray_seconds->median,
                       f.povray_seconds->median / f.seconds.median);
  for (const EmbreeFrame& e : f.embree)
    out += fmt::format("\n  {}: {:.4f} s ({:.4f} to {:.4f}), {:.2f} times as long; {:.2f} M rays", e.name,
                       e.seconds.median, e.seconds.min, e.seconds.max, e.seconds.median / f.seconds.median,
                       millions(e.n_rays));
  return out + "\n";
}

Json json_of(std::span<const FrameResult> frames, const FramesOptions& options) {
  return {{"command", "bench frames"},
          {"embree", embree_json(options.embree)},
          {"size", {options.width, options.height}},
          {"depth", options.depth},
          {"repeat", options.repeat},
          {"frames", json_list(frames, [](const FrameResult& f) { return json_of(f); })}};
}

}  // namespace kdray::bench
