// What    Embree as an asker of `bench queries`, in one form: rays one by one or in packets of 16, flagged as
//         coherent or not, on a fast scene or a robust one; points one by one, as rtcPointQuery has them.
// Shape   All hits and counts by a filter of occlusion rays that notes every hit and accepts none: no order
//         is asked of the walk, and hits are sorted afterwards, as kdray's are. These have a scene of their
//         own, since a filter slows other rays down.
#pragma once

#include <memory>

#include "bench/embree/array_rays.h"
#include "bench/embree/array_scene.h"
#include "bench/embree/workers.h"
#include "bench/race/asker.h"

namespace kdray::bench {

// The mesh's scenes in one mode.
struct EmbreeMesh {
  EmbreeMesh(const MeshArrays& mesh, bool robust, int threads);

  const MeshArrays& arrays;
  std::shared_ptr<EmbreeDevice> device = std::make_shared<EmbreeDevice>();
  ArrayScene plain, counting, collecting;
  Workers workers;
};

class EmbreeAsker : public Asker {
 public:
  EmbreeAsker(std::shared_ptr<EmbreeMesh> mesh, const RayForm& form) : mesh_(std::move(mesh)), form_(form) {}
  void ask(Question question, const QuerySet& set, std::size_t first, std::size_t n,
           Answers& answers) override;

 private:
  std::shared_ptr<EmbreeMesh> mesh_;
  RayForm form_;
};

// The filters of EmbreeMesh, and the questions that are answered with them.
void note_count(const RTCFilterFunctionNArguments* args);
void note_hit(const RTCFilterFunctionNArguments* args);
void count_crossings(EmbreeMesh& mesh, const RayForm& form, const QuerySet& set, std::size_t first,
                     std::size_t n, std::vector<std::uint32_t>& counts);
AllHits all_crossings(EmbreeMesh& mesh, const RayForm& form, const QuerySet& set, std::size_t first,
                      std::size_t n);

// On the mesh's triangles, in floats.
void nearest_points(EmbreeMesh& mesh, const QuerySet& set, std::size_t first, std::size_t n,
                    Answers& answers);

}  // namespace kdray::bench
