// What    What every query needs: a scene that is ready, on the queues that answer, and what its numbers mean.
// Shape   A place is what works by itself: a device, or each of the equal parts that it is divided into.
#pragma once

#include <deque>

#include "accel/prepare/prepared.h"
#include "engine/query/all_sessions.h"
#include "engine/query/geometry_table.h"
#include "engine/query/local_rays.h"

namespace kdray::query {

struct Place {
  explicit Place(const Target& asked) : target(asked), sessions(target) {}

  const Target target;  // of rays in the scene's own space
  AllSessions sessions;
};

struct QueryContext {
  std::deque<Place>& places;  // one at least, of the same scene
  const GeometryTable& table;
  const LocalFrame& frame;

  const prepare::Prepared& scene() const { return places.front().target.scene; }
  bool has_masks() const { return places.front().target.masks() != nullptr; }
};

}  // namespace kdray::query
