// What    A call of Embree's for one ray, 8, 16 and a stream, closest and any hit, of either version: what a
//         thread hands over besides scene and rays.
#pragma once

#include "bench/embree/library.h"

namespace kdray::bench::embree {

inline constexpr unsigned kStreamPackets = 16;  // of 16 rays

class Query {
 public:
  // `user`: what a filter finds by user_of().
  Query(const Library& library, bool coherent, void* user = nullptr) : library_(library) {
    if (library.major == 3) {
      context_.of3 = {coherent ? kCoherent3 : 0, nullptr, kNone};
    } else {
      context_.of4 = {kNone, kNone};
      arguments_.flags = coherent ? kCoherent4 : 0;
      if (user != nullptr) arguments_.context = &context_;
    }
    context_.user = user;
  }
  Query(const Query&) = delete;
  Query& operator=(const Query&) = delete;

  // Lanes count whose `valid` is -1; of a single ray it isn't asked.
  template <unsigned N>
  void trace(Scene scene, const int* valid, RayHits<N>* rays) {
    call<N>(library_.intersect[kWidth<N>], scene, valid, rays);
  }
  template <unsigned N>
  void trace(Scene scene, const int* valid, Rays<N>* rays) {
    call<N>(library_.occluded[kWidth<N>], scene, valid, rays);
  }

  // Of version 3.
  void stream(Scene scene, RayHits<16>* rays, unsigned n_packets) {
    library_.intersect_nm(scene, &context_, rays, 16, n_packets, sizeof(*rays));
  }
  void stream(Scene scene, Rays<16>* rays, unsigned n_packets) {
    library_.occluded_nm(scene, &context_, rays, 16, n_packets, sizeof(*rays));
  }

 private:
  template <unsigned N>
  static constexpr int kWidth = N == 1   ? 0
                                : N == 8 ? 1
                                         : 2;

  template <unsigned N>
  void call(Library::Function function, Scene scene, const int* valid, void* rays) {
    if (library_.major == 3) {
      if constexpr (N == 1)
        reinterpret_cast<void (*)(Scene, Context*, void*)>(function)(scene, &context_, rays);
      else
        reinterpret_cast<void (*)(const int*, Scene, Context*, void*)>(function)(valid, scene, &context_,
                                                                                 rays);
    } else {
      if constexpr (N == 1)
        reinterpret_cast<void (*)(Scene, void*, Arguments*)>(function)(scene, rays, &arguments_);
      else
        reinterpret_cast<void (*)(const int*, Scene, void*, Arguments*)>(function)(valid, scene, rays,
                                                                                   &arguments_);
    }
  }

  const Library& library_;
  Context context_;
  Arguments arguments_{0, ~0u, nullptr, nullptr, nullptr};
};

// In a filter: what the Query was made with.
inline void* user_of(const FilterArguments* args) {
  return args->context->user;
}

}  // namespace kdray::bench::embree
