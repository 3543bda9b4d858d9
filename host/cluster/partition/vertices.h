// What    The vertices of a mesh, of which each rank holds a run; and asking their holders for some.
// Shape   Whoever needs vertices names them in ascending order, each once, and gets them in that order. All
//         ranks ask at the same time, those that need nothing as well.
// Memory  What is asked for at a time, twice.
#pragma once

#include <cstdint>
#include <vector>

#include "base/box.h"
#include "cluster/transport/together.h"
#include "scene/import/ply/ply_rows.h"

namespace kdray::partition {

class VertexHolders {
 public:
  // `own` are those of slice_of(rows.n_vertices(), rank, size).
  VertexHolders(transport::Together& all, const scene::ply::Rows& rows, scene::ply::Vertices own);

  // That somebody uses them.
  void use(const std::vector<std::uint32_t>& wanted);
  // The bounds are those of all that somebody uses.
  DBox bounds_of_used();

  scene::ply::Vertices fetch(const std::vector<std::uint32_t>& wanted);

 private:
  std::vector<std::vector<std::uint32_t>> ask(const std::vector<std::uint32_t>& wanted);

  transport::Together& all_;
  std::uint64_t n_vertices_;
  scene::ply::VertexColumns columns_;
  std::uint64_t first_;
  scene::ply::Vertices own_;
  std::vector<std::uint8_t> used_;
};

}  // namespace kdray::partition
