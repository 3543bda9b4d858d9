#include "bench/embree/asker.h"

#include "base/error.h"
#include "bench/embree/sides.h"

namespace kdray::bench {

namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr auto kAddNothing = [](RTCRayN*, unsigned, std::size_t) {};

template <unsigned N>
void closest(EmbreeMesh& mesh, bool coherent, const QuerySet& set, std::size_t first, std::size_t n,
             Answers& a) {
  mesh.workers.run(n, [&](std::size_t, std::size_t begin, std::size_t end) {
    Query query(coherent);
    trace_rays<N, false>(mesh.plain.get(), query, set, first + begin, first + end, kAddNothing,
                         [&](Packed<N, false>& packed, unsigned lane, std::size_t i) {
                           auto* const both = reinterpret_cast<RTCRayHitN*>(&packed);
                           RTCHitN* const hit = RTCRayHitN_HitN(both, N);
                           const unsigned geometry = RTCHitN_geomID(hit, N, lane);
                           const bool missed = geometry == RTC_INVALID_GEOMETRY_ID;
                           a.t[i] = missed ? kInfinity : RTCRayN_tfar(RTCRayHitN_RayN(both, N), N, lane);
                           a.geometry[i] = geometry;
                           a.primitive[i] = missed ? kNoPrimitive : RTCHitN_primID(hit, N, lane);
                           a.u[i] = missed ? 0 : RTCHitN_u(hit, N, lane);
                           a.v[i] = missed ? 0 : RTCHitN_v(hit, N, lane);
                         });
  });
}

template <unsigned N>
void any(EmbreeMesh& mesh, bool coherent, const QuerySet& set, std::size_t first, std::size_t n, Answers& a) {
  mesh.workers.run(n, [&](std::size_t, std::size_t begin, std::size_t end) {
    Query query(coherent);
    trace_rays<N, true>(mesh.plain.get(), query, set, first + begin, first + end, kAddNothing,
                        [&](Packed<N, true>& packed, unsigned lane, std::size_t i) {
                          // Embree's own mark of an occluded ray.
                          a.hit[i] = RTCRayN_tfar(reinterpret_cast<RTCRayN*>(&packed), N, lane) < 0;
                        });
  });
}

Side side(const MeshArrays& mesh, bool robust, int threads) {
  const auto made = std::make_shared<EmbreeMesh>(mesh, robust, threads);
  Side side{robust ? "robust" : "fast", {}, {}};
  for (const unsigned lanes : {1u, 16u})
    for (const bool coherent : {true, false})
      side.forms.push_back({std::to_string(lanes) + (coherent ? " coherent" : " incoherent"),
                            std::make_shared<EmbreeAsker>(made, RayForm{coherent, lanes})});
  side.first_answer = [&mesh, robust](const QuerySet& set) {
    const ArrayScene scene(std::make_shared<EmbreeDevice>(), mesh, robust, nullptr);
    Query query(true);
    trace_rays<1, false>(scene.get(), query, set, 0, 1, kAddNothing, [](auto&, unsigned, std::size_t) {});
  };
  return side;
}

}  // namespace

EmbreeMesh::EmbreeMesh(const MeshArrays& mesh, bool robust, int threads)
    : arrays(mesh),
      plain(device, mesh, robust, nullptr),
      counting(device, mesh, robust, note_count),
      collecting(device, mesh, robust, note_hit),
      workers(threads) {}

void EmbreeAsker::ask(Question question, const QuerySet& set, std::size_t first, std::size_t n, Answers& a) {
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

std::vector<Side> embree_sides(const MeshArrays& mesh, int threads) {
  return {side(mesh, false, threads), side(mesh, true, threads)};
}

bool embree_answers(Question question) {
  return question != Question::distance && question != Question::inside;
}

}  // namespace kdray::bench
