#include "bench/embree/asker.h"

#include <fmt/format.h>

#include "base/error.h"
#include "bench/embree/sides.h"

namespace kdray::bench::embree {

namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr auto kAddNothing = [](auto&, unsigned, std::size_t) {};

template <unsigned N>
void closest(Mesh& mesh, bool coherent, const QuerySet& set, std::size_t first, std::size_t n, Answers& a) {
  mesh.workers.run(n, [&](std::size_t, std::size_t begin, std::size_t end) {
    Query query(mesh.plain.library(), coherent);
    trace_rays<N, false>(mesh.plain.get(), query, set, first + begin, first + end, kAddNothing,
                         [&](Packed<N, false>& packed, unsigned lane, std::size_t i) {
                           const Hits<N>& hit = packed.hit;
                           const bool missed = hit.geometry[lane] == kNone;
                           a.t[i] = missed ? kInfinity : packed.ray.t_far[lane];
                           a.geometry[i] = hit.geometry[lane];
                           a.primitive[i] = missed ? kNoPrimitive : hit.primitive[lane];
                           a.u[i] = missed ? 0 : hit.u[lane];
                           a.v[i] = missed ? 0 : hit.v[lane];
                         });
  });
}

template <unsigned N>
void any(Mesh& mesh, bool coherent, const QuerySet& set, std::size_t first, std::size_t n, Answers& a) {
  mesh.workers.run(n, [&](std::size_t, std::size_t begin, std::size_t end) {
    Query query(mesh.plain.library(), coherent);
    trace_rays<N, true>(mesh.plain.get(), query, set, first + begin, first + end, kAddNothing,
                        [&](Packed<N, true>& packed, unsigned lane, std::size_t i) {
                          // Embree's own mark of an occluded ray.
                          a.hit[i] = packed.t_far[lane] < 0;
                        });
  });
}

void add_forms(Side& side, const std::shared_ptr<Mesh>& mesh) {
  for (const unsigned lanes : {1u, 16u})
    for (const bool coherent : {true, false})
      side.forms.push_back({fmt::format("{}:{} {}", mesh->device->library().major, lanes,
                                        coherent ? "coherent" : "incoherent"),
                            std::make_shared<MeshAsker>(mesh, RayForm{coherent, lanes})});
}

Side side(const MeshArrays& mesh, bool robust, int threads) {
  Side side{robust ? "robust" : "fast", {}, {}};
  for (const Library& library : libraries())
    add_forms(side, std::make_shared<Mesh>(library, mesh, robust, threads));
  side.first_answer = [&mesh, robust](const QuerySet& set) {
    const Library& newest = libraries().back();
    const ArrayScene scene(std::make_shared<OpenDevice>(newest), mesh, robust, nullptr);
    Query query(newest, true);
    trace_rays<1, false>(scene.get(), query, set, 0, 1, kAddNothing, [](auto&, unsigned, std::size_t) {});
  };
  return side;
}

}  // namespace

Mesh::Mesh(const Library& library, const MeshArrays& mesh, bool robust, int threads)
    : arrays(mesh),
      device(std::make_shared<OpenDevice>(library)),
      plain(device, mesh, robust, nullptr),
      counting(device, mesh, robust, note_count),
      collecting(device, mesh, robust, note_hit),
      workers(threads) {}

void MeshAsker::ask(Question question, const QuerySet& set, std::size_t first, std::size_t n, Answers& a) {
  switch (question) {
    case Question::closest:
      return form_.lanes == 1 ? closest<1>(*mesh_, form_.coherent, set, first, n, a)
                              : closest<16>(*mesh_, form_.coherent, set, first, n, a);
    case Question::any:
      return form_.lanes == 1 ? any<1>(*mesh_, form_.coherent, set, first, n, a)
                              : any<16>(*mesh_, form_.coherent, set, first, n, a);
    case Question::count:
      return count_crossings(*mesh_, form_, set, first, n, a.count);
    case Question::all:
      a.all = all_crossings(*mesh_, form_, set, first, n);
      return;
    case Question::points:
      return nearest_points(*mesh_, set, first, n, a);
    default:
      throw Error(ErrorCode::internal, "a question that Embree has no answer to was put to it");
  }
}

}  // namespace kdray::bench::embree

namespace kdray::bench {

std::vector<Side> embree_sides(const MeshArrays& mesh, int threads) {
  if (embree::libraries().empty()) return {};
  return {embree::side(mesh, false, threads), embree::side(mesh, true, threads)};
}

bool embree_answers(Question question) {
  return question != Question::distance && question != Question::inside;
}

}  // namespace kdray::bench
