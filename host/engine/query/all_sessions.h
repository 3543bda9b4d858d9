// What    The sessions of every query about a scene (sessions.h).
#pragma once

#include <atomic>
#include <cstddef>

#include "engine/query/passes.h"
#include "engine/query/point_session.h"
#include "engine/query/session.h"

namespace kdray::query {

struct AllSessions {
  explicit AllSessions(const Target& target)
      : unmasked(without_masks(target)), rays(target), crossings(target), of_all(unmasked), points(target) {}

  Target unmasked;
  Sessions<Session> rays;      // closest, any
  Sessions<Passes> crossings;  // count, all
  Sessions<Passes> of_all;     // of every geometry, whatever its mask: inside
  Sessions<PointSession> points;
  std::atomic<std::size_t> counted_at_once{0}, collected_at_once{0}, points_at_once{0};  // pace.h

 private:
  static Target without_masks(Target target) {
    target.masks = cl::Buffer();
    return target;
  }
};

}  // namespace kdray::query
