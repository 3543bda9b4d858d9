#include "bench/embree/asker.h"

#include <fmt/format.h>

#include "base/error.h"
#include "bench/embree/embree.h"

namespace kdray::bench::embree {

namespace {

// take(packed, lane, i) finds what became of each ray of the set.
template <unsigned N, bool any_hit, class Take>
void trace_set(Mesh& mesh, bool coherent, const QuerySet& set, std::size_t first, std::size_t n,
               const Take& take) {
  mesh.workers.run(n, [&](std::size_t, std::size_t begin, std::size_t end) {
    Query query(mesh.plain.library(), coherent);
    trace_rays<N, any_hit>(mesh.plain.get(), query, first + begin, first + end, rays_from(set), take);
  });
}

template <unsigned N>
void closest(Mesh& mesh, bool coherent, const QuerySet& set, std::size_t first, std::size_t n, Answers& a) {
  const auto take = [&](const RayHits<N>& packed, unsigned lane, std::size_t i) {
    const Hits<N>& hit = packed.hit;
    const bool missed = hit.geometry[lane] == kNone;
    a.t[i] = missed ? kInfinity : packed.ray.t_far[lane];
    a.geometry[i] = hit.geometry[lane];
    a.primitive[i] = missed ? kNoPrimitive : hit.primitive[lane];
    a.u[i] = missed ? 0 : hit.u[lane];
    a.v[i] = missed ? 0 : hit.v[lane];
  };
  trace_set<N, false>(mesh, coherent, set, first, n, take);
}

template <unsigned N>
void any(Mesh& mesh, bool coherent, const QuerySet& set, std::size_t first, std::size_t n, Answers& a) {
  trace_set<N, true>(mesh, coherent, set, first, n, [&](const Rays<N>& rays, unsigned lane, std::size_t i) {
    a.hit[i] = rays.t_far[lane] < 0;  // Embree's own mark of an occluded ray
  });
}

void add_forms(Side& side, const std::shared_ptr<Mesh>& mesh) {
  for (const unsigned lanes : {1u, 16u})
    for (const bool coherent : {true, false})
      side.forms.push_back(
          {fmt::format("{}:{} {}", mesh->plain.library().major, lanes, coherent ? "coherent" : "incoherent"),
           std::make_shared<MeshAsker>(mesh, RayForm{coherent, lanes})});
}

Side side(const MeshArrays& mesh, bool robust, int threads) {
  Side side{robust ? "robust" : "fast", {}, {}};
  for (const Library& library : libraries())
    add_forms(side, std::make_shared<Mesh>(library, mesh, robust, threads));
  side.first_answer = [&mesh, robust](const QuerySet& set) {
    const Library& newest = libraries().back();
    const KindBuffers buffers = buffers_of(mesh);
    OwnedScene scene(std::make_shared<OpenDevice>(newest), robust);
    scene.add(buffers);
    scene.commit();
    Query query(newest, true);
    trace_rays<1, false>(scene.get(), query, 0, 1, rays_from(set), [](auto&, unsigned, std::size_t) {});
  };
  return side;
}

}  // namespace

Mesh::Mesh(const Library& library, const MeshArrays& mesh, bool robust, int threads)
    : Mesh(std::make_shared<OpenDevice>(library), mesh, robust, threads) {}

Mesh::Mesh(const std::shared_ptr<OpenDevice>& device, const MeshArrays& mesh, bool robust, int threads)
    : arrays(mesh),
      buffers(buffers_of(mesh)),
      plain(device, robust),
      counting(device, robust),
      collecting(device, robust),
      workers(threads) {
  plain.add(buffers);
  counting.add(buffers, note_count);
  collecting.add(buffers, note_hit);
  for (OwnedScene* const scene : {&plain, &counting, &collecting}) scene->commit();
}

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
