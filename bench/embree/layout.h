// What    What Embree's calls take and give, as it lies in memory: handles, names of things, rays and hits
//         of N to a struct, what filters and point queries are told. Stated here, so that no Embree is
//         needed to build this, and so that one program can have versions 3 and 4.
// Shape   Both versions share all of it but what says so. Rows are floats or words, N to a row.
// Source  The public headers of Embree 3.13 and 4.4, by their defaults: one level of instances, no minimal
//         width.
#pragma once

#include <cstddef>
#include <cstdint>

namespace kdray::bench::embree {

using Device = struct DeviceObject*;
using Scene = struct SceneObject*;
using Geometry = struct GeometryObject*;

enum class GeometryType : int {
  triangle = 0,
  cone_linear_curve = 15,
  sphere_point = 50,
  oriented_disc_point = 52,
  user = 120,
  instance = 121
};
enum class BufferType : int { index = 0, vertex = 1, normal = 3, flags = 32 };
enum class Format : int {
  uchar = 0x1001,
  uint = 0x5001,
  uint3 = 0x5003,
  float3 = 0x9003,
  float4 = 0x9004,
  float3x4_column_major = 0x9234
};
enum class SceneFlags : int { none = 0, robust = 1 << 2 };
enum class BuildQuality : int { medium = 1 };
enum class DeviceProperty : int { version = 0 };  // major * 10000 + minor * 100 + patch

inline constexpr std::uint32_t kNone = ~0u;                           // no geometry, no instance
inline constexpr std::uint8_t kNeighborLeft = 1, kNeighborRight = 2;  // of a curve's segment

// ---- Rays

template <unsigned N>
inline constexpr std::size_t kAlignment = N == 1 ? 16 : N * sizeof(float);

// What any hit ends: t_far is -infinity then.
template <unsigned N>
struct alignas(kAlignment<N>) Rays {
  float origin[3][N], t_near[N], direction[3][N], time[N], t_far[N];
  std::uint32_t mask[N], id[N], flags[N];
};

template <unsigned N>
struct alignas(kAlignment<N>) Hits {
  float normal[3][N], u[N], v[N];
  std::uint32_t primitive[N], geometry[N], instance[N];
};

template <unsigned N>
struct RayHits {
  Rays<N> ray;
  Hits<N> hit;
  std::uint32_t instance_primitive[N];  // Embree 4 writes it
};

static_assert(sizeof(Rays<1>) == 48 && sizeof(Rays<16>) == 12 * 64);
static_assert(offsetof(RayHits<1>, instance_primitive) == 80);
static_assert(offsetof(RayHits<16>, instance_primitive) == 20 * 64);

// ---- What is handed over with rays

struct FilterArguments;
using Filter = void (*)(const FilterArguments*);

// Of version 3 `flags` are of the context, of version 4 of the arguments.
struct Context {
  union {
    struct {
      int flags;
      Filter filter;
      std::uint32_t instance;
    } of3;
    struct {
      std::uint32_t instance, instance_primitive;
    } of4;
  };
  void* user;  // ours, behind what is Embree's
};

inline constexpr int kCoherent3 = 1, kCoherent4 = 1 << 16;  // flags; 0: incoherent

// Of version 4 alone.
struct Arguments {
  int flags;
  std::uint32_t features;  // ~0: all
  Context* context;
  Filter filter;
  void (*callback)();
};

struct FilterArguments {
  int* valid;  // -1 or 0 for each lane; 0 refuses the hit
  void* geometry_user;
  const Context* context;
  const void* rays;  // Rays<n>; t_far is the hit's
  const void* hits;  // Hits<n>
  unsigned n;
};

// Rows of rays and hits whose number is known at run time alone.
enum class RayRow : unsigned { t_far = 8, id = 10 };
enum class HitRow : unsigned { u = 3, v = 4, primitive = 5, geometry = 6 };

template <class T>
T at(const FilterArguments* a, RayRow row, unsigned lane) {
  return static_cast<const T*>(a->rays)[static_cast<unsigned>(row) * a->n + lane];
}
template <class T>
T at(const FilterArguments* a, HitRow row, unsigned lane) {
  return static_cast<const T*>(a->hits)[static_cast<unsigned>(row) * a->n + lane];
}

// ---- Closest points

struct alignas(16) PointQuery {
  float x, y, z, time, radius;
};

// The depth of instances lies behind their number in version 3, one word further in version 4.
struct alignas(16) PointContext {
  float to_instance[16], to_world[16];
  std::uint32_t instance = kNone, depth3 = 0, depth4 = 0;
};

struct alignas(16) PointArguments {
  PointQuery* query;
  void* user;
  std::uint32_t primitive, geometry;
  PointContext* context;
  float similarity_scale;
};

using PointFunction = bool (*)(PointArguments*);

}  // namespace kdray::bench::embree
