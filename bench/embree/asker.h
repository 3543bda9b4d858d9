// What    Embree as an asker of `bench queries`, in one form: rays one by one or in packets of 16, flagged as
//         coherent or not, on a fast scene or a robust one; points one by one, as rtcPointQuery has them.
// Shape   All hits and counts by a filter of occlusion rays that notes every hit and accepts none: no order
//         is asked of the walk, and hits are sorted afterwards, as kdray's are. These have a scene of their
//         own, since a filter slows other rays down.
#pragma once

#include <memory>

#include "bench/embree/packets.h"
#include "bench/embree/scenes.h"
#include "bench/embree/workers.h"
#include "bench/race/asker.h"

namespace kdray::bench::embree {

// A form of tracing.
struct RayForm {
  bool coherent;
  unsigned lanes;  // 1, 16
};

// The mesh's scenes in one mode.
struct Mesh {
  Mesh(const Library& library, const MeshArrays& mesh, bool robust, int threads);

  const MeshArrays& arrays;
  KindBuffers buffers;
  OwnedScene plain, counting, collecting;
  Workers workers;

 private:
  Mesh(const std::shared_ptr<OpenDevice>& device, const MeshArrays& mesh, bool robust, int threads);
};

// Puts ray i of the set, for trace_rays().
inline auto rays_from(const QuerySet& set) {
  return [&set](auto& rays, unsigned lane, std::size_t i) {
    put_ray(rays, lane, &set.origins[3 * i], &set.directions[3 * i]);
  };
}

class MeshAsker : public Asker {
 public:
  MeshAsker(std::shared_ptr<Mesh> mesh, const RayForm& form) : mesh_(std::move(mesh)), form_(form) {}
  void ask(Question question, const QuerySet& set, std::size_t first, std::size_t n,
           Answers& answers) override;

 private:
  std::shared_ptr<Mesh> mesh_;
  RayForm form_;
};

// The filters of Mesh, and the questions that are answered with them.
void note_count(const FilterArguments* args);
void note_hit(const FilterArguments* args);
void count_crossings(Mesh& mesh, const RayForm& form, const QuerySet& set, std::size_t first, std::size_t n,
                     std::vector<std::uint32_t>& counts);
AllHits all_crossings(Mesh& mesh, const RayForm& form, const QuerySet& set, std::size_t first, std::size_t n);

// On the mesh's triangles, in floats.
void nearest_points(Mesh& mesh, const QuerySet& set, std::size_t first, std::size_t n, Answers& answers);

}  // namespace kdray::bench::embree
