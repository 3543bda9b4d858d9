#include "engine/frame/result.h"

namespace kdray::frame {

void put_share(const Result& result, transport::Writer& writer) {
  writer(result.counters, result.stage_seconds.size());
  for (const auto& [stage, seconds] : result.stage_seconds) writer(stage, seconds);
}

void add_share(transport::Reader& reader, Result& result) {
  result.counters.add(reader.get<wavefront::Counters>());
  for (auto n = reader.get<std::size_t>(); n > 0; --n) {
    const std::string stage = reader.get_text();
    result.stage_seconds[stage] += reader.get<double>();
  }
}

}  // namespace kdray::frame
