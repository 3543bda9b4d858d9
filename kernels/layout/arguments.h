// What    The arguments of every kernel, each kernel's as one list of names: the kernel's parameters follow
//         from it (KDRAY_PARAMETERS) and so do the names by which the host sets them
//         (host/device/opencl/kernel.h).
// Shape   An entry is X(access, type, name). Arrays: IN (read), OUT (written), IO (both), CONSTANT (one
//         struct that all work-items read); VALUE is passed by itself. In the kernel an array bears its
//         access in its name, such as in_nodes, io_film or out_hits; for the host it is nodes, film or hits,
//         the same name in every kernel. A kernel's list is called with two macros, F for its first entry and
//         X for the others, since parameters stand between commas. Groups that several kernels share never
//         come first, and take X alone.
// Why     Order and number of arguments are written nowhere else. An argument that is added here and set
//         nowhere is refused at the first launch, by name; one that is set and is not here does not compile.
#ifndef KDRAY_LAYOUT_ARGUMENTS_H
#define KDRAY_LAYOUT_ARGUMENTS_H
#include "layout/instances.layout.h"
#include "layout/kinds.h"

// The scene's arrays. host/engine/wavefront/scene_buffers.h holds a buffer for each of them, by these names.
#define KDRAY_PRIMITIVE_ARRAYS(X)          \
  KDRAY_KINDS_WITH(KDRAY_ARRAY_OF_KIND, X) \
  X(IN, Instance, instances)
#define KDRAY_ARRAY_OF_KIND(X, NAME, name, names, Struct) X(IN, Struct, names)
#define KDRAY_TREE_ARRAYS(X)  \
  X(IN, KdNode, nodes)        \
  X(IN, u32, refs)            \
  X(IN, WideNode, wide_nodes) \
  KDRAY_KINDS_WITH(KDRAY_BLOCKS_OF_KIND, X)
#define KDRAY_BLOCKS_OF_KIND(X, NAME, name, names, Struct) X(IN, float, name##_blocks)
#define KDRAY_NORMAL_ARRAYS(X) X(IN, VertexNormals, normals)
// How surfaces are textured.
#define KDRAY_TEXTURING_ARRAYS(X)    \
  X(IN, Material, materials)         \
  X(IN, MaterialMaps, material_maps) \
  X(IN, Texture, textures)           \
  X(IN, u32, texels)                 \
  X(IN, TexCoords, texcoords)        \
  X(IN, CornerColors, corner_colors)
// What rays that meet nothing see, where that is not one colour.
#define KDRAY_SKY_ARRAYS(X) \
  X(IN, Sky, sky)           \
  X(IN, float, sky_colors)
#define KDRAY_LOOK_ARRAYS(X) \
  KDRAY_TEXTURING_ARRAYS(X)  \
  X(IN, Light, lights)       \
  KDRAY_SKY_ARRAYS(X)

// What tracing reads, and what finding the surface at a hit reads.
#define KDRAY_TRACED_ARRAYS(X) \
  KDRAY_TREE_ARRAYS(X)         \
  KDRAY_PRIMITIVE_ARRAYS(X)
#define KDRAY_SURFACE_ARRAYS(X) \
  KDRAY_PRIMITIVE_ARRAYS(X)     \
  KDRAY_NORMAL_ARRAYS(X)
#define KDRAY_SCENE_ARRAYS(X) \
  KDRAY_TREE_ARRAYS(X)        \
  KDRAY_PRIMITIVE_ARRAYS(X)   \
  KDRAY_NORMAL_ARRAYS(X)      \
  KDRAY_LOOK_ARRAYS(X)

// All kernels: X(the host's name, file, function, list).
#define KDRAY_KERNELS(X)                                                                        \
  X(Wave, "wave/wave.cl", wave, KDRAY_WAVE_ARGUMENTS)                                           \
  X(Plan, "wave/plan.cl", plan, KDRAY_PLAN_ARGUMENTS)                                           \
  X(Admit, "raygen/admit.cl", admit, KDRAY_ADMIT_ARGUMENTS)                                     \
  X(TraceClosest, "traverse/trace_closest.cl", trace_closest, KDRAY_TRACE_CLOSEST_ARGUMENTS)    \
  X(Shade, "shade/shade.cl", shade, KDRAY_SHADE_ARGUMENTS)                                      \
  X(TraceShadow, "traverse/trace_shadow.cl", trace_shadow, KDRAY_TRACE_SHADOW_ARGUMENTS)        \
  X(Add, "film/add.cl", add, KDRAY_ADD_ARGUMENTS)                                               \
  X(Channels, "film/channels.cl", channels, KDRAY_CHANNELS_ARGUMENTS)                           \
  X(TraceQuery, "traverse/query.cl", trace_query, KDRAY_TRACE_QUERY_ARGUMENTS)                  \
  X(CollectHits, "traverse/collect.cl", collect_hits, KDRAY_COLLECT_HITS_ARGUMENTS)             \
  X(PackHits, "traverse/collect.cl", pack_hits, KDRAY_PACK_HITS_ARGUMENTS)                      \
  X(ClosestPoints, "closest/closest_points.cl", closest_points, KDRAY_CLOSEST_POINTS_ARGUMENTS) \
  X(Depart, "shade/depart.cl", depart, KDRAY_DEPART_ARGUMENTS)                                  \
  X(TravelWave, "odprt/wave.cl", travel_wave, KDRAY_TRAVEL_WAVE_ARGUMENTS)                      \
  X(Receive, "odprt/receive.cl", receive, KDRAY_RECEIVE_ARGUMENTS)                              \
  X(TravelPlan, "odprt/stages/plan.cl", travel_plan, KDRAY_TRAVEL_PLAN_ARGUMENTS)               \
  X(TravelAdmit, "odprt/stages/admit.cl", admit, KDRAY_ADMIT_ARGUMENTS)                         \
  X(TravelTrace, "odprt/stages/trace.cl", travel_trace, KDRAY_TRAVEL_TRACE_ARGUMENTS)           \
  X(TravelShade, "odprt/stages/shade.cl", shade, KDRAY_SHADE_ARGUMENTS)                         \
  X(TravelShadow, "odprt/stages/shadow.cl", travel_shadow, KDRAY_TRAVEL_SHADOW_ARGUMENTS)       \
  X(TravelReceive, "odprt/stages/receive.cl", travel_receive, KDRAY_RECEIVE_ARGUMENTS)          \
  X(SimdTest, "common/simd_test.cl", simd_test, KDRAY_SIMD_TEST_ARGUMENTS)

#define KDRAY_WAVE_ARGUMENTS(F, X) \
  F(CONSTANT, Frame, frame)        \
  X(VALUE, u32, n_slices)          \
  X(VALUE, u32, n_waves)           \
  KDRAY_SCENE_ARRAYS(X)            \
  X(IO, Slice, slices)             \
  X(IN, u32, tiles)                \
  X(VALUE, u32, n_tiles)           \
  X(IO, u64, tile_cycles)          \
  X(IO, real, pool)                \
  X(IO, real, batch)               \
  X(IO, real, hits)                \
  X(IO, real, shadow_rays)         \
  X(IO, uchar, occluded)           \
  X(IO, i64, film)

// Where every ray has a work-item, the rays of a queue are those of one slice.
#define KDRAY_PLAN_ARGUMENTS(F, X) \
  F(CONSTANT, Frame, frame)        \
  X(VALUE, u32, n_tiles)           \
  X(IO, Slice, slices)

#define KDRAY_ADMIT_ARGUMENTS(F, X) \
  F(CONSTANT, Frame, frame)         \
  X(IO, Slice, slices)              \
  X(IN, u32, tiles)                 \
  X(IN, real, pool)                 \
  X(OUT, real, batch)

#define KDRAY_TRACE_CLOSEST_ARGUMENTS(F, X) \
  F(CONSTANT, Frame, frame)                 \
  KDRAY_TRACED_ARRAYS(X)                    \
  KDRAY_TEXTURING_ARRAYS(X)                 \
  X(IN, Slice, slices)                      \
  X(IN, real, batch)                        \
  X(OUT, real, hits)

#define KDRAY_SHADE_ARGUMENTS(F, X) \
  F(CONSTANT, Frame, frame)         \
  X(VALUE, u32, first_light)        \
  KDRAY_SURFACE_ARRAYS(X)           \
  KDRAY_LOOK_ARRAYS(X)              \
  X(IO, Slice, slices)              \
  X(IN, real, batch)                \
  X(IN, real, hits)                 \
  X(IO, real, pool)                 \
  X(OUT, real, shadow_rays)         \
  X(IO, i64, film)

#define KDRAY_TRACE_SHADOW_ARGUMENTS(F, X) \
  F(CONSTANT, Frame, frame)                \
  KDRAY_TRACED_ARRAYS(X)                   \
  KDRAY_TEXTURING_ARRAYS(X)                \
  X(IN, Slice, slices)                     \
  X(IN, real, shadow_rays)                 \
  X(OUT, uchar, occluded)

#define KDRAY_ADD_ARGUMENTS(F, X) \
  F(CONSTANT, Frame, frame)       \
  X(IO, Slice, slices)            \
  X(IN, real, shadow_rays)        \
  X(IN, uchar, occluded)          \
  X(IO, i64, film)

#define KDRAY_CHANNELS_ARGUMENTS(F, X) \
  F(CONSTANT, Frame, frame)            \
  X(VALUE, u32, first_pixel)           \
  X(VALUE, u32, n_pixels)              \
  KDRAY_TREE_ARRAYS(X)                 \
  KDRAY_SURFACE_ARRAYS(X)              \
  KDRAY_TEXTURING_ARRAYS(X)            \
  X(OUT, float, channels)

#define KDRAY_TRACE_QUERY_ARGUMENTS(F, X) \
  F(VALUE, float4, root_lo)               \
  X(VALUE, float4, root_hi)               \
  X(VALUE, float4, space)                 \
  X(VALUE, float, world_max)              \
  X(VALUE, u32, n_rays)                   \
  X(VALUE, u32, any_hit)                  \
  X(VALUE, u32, any_length)               \
  X(VALUE, u32, as_refs)                  \
  KDRAY_TRACED_ARRAYS(X)                  \
  X(IN, u32, primitive_masks)             \
  X(IN, u32, ray_masks)                   \
  X(IN, QueryRay, rays)                   \
  X(OUT, QueryHit, hits)                  \
  X(OUT, u32, hit_instances)

// The hits are `capacity` for each ray; `after`, where the rays' last pass ended, is read where there was
// one.
#define KDRAY_COLLECT_HITS_ARGUMENTS(F, X) \
  F(VALUE, float4, space)                  \
  X(VALUE, float, world_max)               \
  X(VALUE, u32, n_rays)                    \
  X(VALUE, u32, capacity)                  \
  X(VALUE, u32, goes_on)                   \
  X(VALUE, u32, any_length)                \
  KDRAY_TRACED_ARRAYS(X)                   \
  X(IN, u32, primitive_masks)              \
  X(IN, u32, ray_masks)                    \
  X(IN, QueryRay, rays)                    \
  X(IN, QuerySpan, after)                  \
  X(OUT, QuerySpan, spans)                 \
  X(IO, QueryHit, hits)                    \
  X(IO, u32, hit_instances)

#define KDRAY_PACK_HITS_ARGUMENTS(F, X) \
  F(VALUE, float4, space)               \
  X(VALUE, u32, n_rays)                 \
  X(VALUE, u32, capacity)               \
  X(VALUE, u32, any_length)             \
  X(VALUE, u32, as_refs)                \
  KDRAY_TRACED_ARRAYS(X)                \
  X(IN, QueryRay, rays)                 \
  X(IN, QuerySpan, spans)               \
  X(IN, u32, places)                    \
  X(IN, QueryHit, hits)                 \
  X(IN, u32, hit_instances)             \
  X(OUT, u32, instance)                 \
  X(OUT, float, t)                      \
  X(OUT, u32, primitive)                \
  X(OUT, float, u)                      \
  X(OUT, float, v)

#define KDRAY_CLOSEST_POINTS_ARGUMENTS(F, X) \
  F(VALUE, float4, root_lo)                  \
  X(VALUE, float4, root_hi)                  \
  X(VALUE, float, reach)                     \
  X(VALUE, u32, n_points)                    \
  KDRAY_TRACED_ARRAYS(X)                     \
  X(IN, QueryPoint, points)                  \
  X(OUT, ClosestHit, closest)

#define KDRAY_DEPART_ARGUMENTS(F, X) \
  F(VALUE, u32, n_rays)              \
  KDRAY_SURFACE_ARRAYS(X)            \
  X(IN, QueryRay, rays)              \
  X(IN, KnownHit, hits)              \
  X(OUT, Departure, departures)

// The outbox: streams of the rays that are sent, and how many are in each.
#define KDRAY_TRAVEL_WAVE_ARGUMENTS(F, X) \
  F(CONSTANT, Frame, frame)               \
  X(CONSTANT, Travel, travel)             \
  X(VALUE, u32, n_waves)                  \
  KDRAY_SCENE_ARRAYS(X)                   \
  X(IN, PartCell, cells)                  \
  X(IN, PartCell, subtrees)               \
  X(IN, u32, tiles)                       \
  X(VALUE, u32, n_tiles)                  \
  X(IO, Slice, slices)                    \
  X(IO, Credits, credits)                 \
  X(IO, Traffic, traffic)                 \
  X(IO, float, pool)                      \
  X(IO, float, batch)                     \
  X(IO, float, hits)                      \
  X(IO, float, shadow_rays)               \
  X(IO, uchar, occluded)                  \
  X(IO, float, shadow_pool)               \
  X(IO, i64, film)                        \
  X(OUT, float, sent_rays)                \
  X(OUT, float, sent_shadow_rays)         \
  X(OUT, u32, sent_counts)                \
  X(OUT, u32, visits)

#define KDRAY_RECEIVE_ARGUMENTS(F, X) \
  F(CONSTANT, Frame, frame)           \
  X(CONSTANT, Travel, travel)         \
  X(VALUE, u32, place)                \
  X(VALUE, u32, n_places)             \
  X(VALUE, u32, ray_capacity)         \
  X(VALUE, u32, shadow_capacity)      \
  X(IN, float, sent_rays)             \
  X(IN, float, sent_shadow_rays)      \
  X(IN, u32, sent_counts)             \
  X(IO, Slice, slices)                \
  X(IO, Traffic, traffic)             \
  X(IO, float, pool)                  \
  X(IO, float, shadow_pool)

// Where every ray has a work-item, of waves 0 to n_waves: the last one closes the account.
#define KDRAY_TRAVEL_PLAN_ARGUMENTS(F, X) \
  F(CONSTANT, Frame, frame)               \
  X(CONSTANT, Travel, travel)             \
  X(VALUE, u32, wave)                     \
  X(VALUE, u32, n_waves)                  \
  X(VALUE, u32, n_tiles)                  \
  X(IO, Slice, slices)                    \
  X(IO, Credits, credits)                 \
  X(IO, Traffic, traffic)                 \
  X(OUT, u32, sent_counts)

#define KDRAY_TRAVEL_TRACE_ARGUMENTS(F, X) \
  F(CONSTANT, Frame, frame)                \
  X(CONSTANT, Travel, travel)              \
  KDRAY_TRACED_ARRAYS(X)                   \
  KDRAY_TEXTURING_ARRAYS(X)                \
  X(IN, PartCell, cells)                   \
  X(IN, PartCell, subtrees)                \
  X(IO, Slice, slices)                     \
  X(IO, Traffic, traffic)                  \
  X(IO, float, batch)                      \
  X(IO, float, hits)                       \
  X(OUT, float, sent_rays)                 \
  X(OUT, u32, sent_counts)                 \
  X(OUT, u32, visits)

#define KDRAY_TRAVEL_SHADOW_ARGUMENTS(F, X) \
  F(CONSTANT, Frame, frame)                 \
  X(CONSTANT, Travel, travel)               \
  X(VALUE, u32, first_light)                \
  KDRAY_TRACED_ARRAYS(X)                    \
  KDRAY_TEXTURING_ARRAYS(X)                 \
  X(IN, PartCell, cells)                    \
  X(IN, PartCell, subtrees)                 \
  X(IO, Slice, slices)                      \
  X(IO, Traffic, traffic)                   \
  X(IO, float, shadow_rays)                 \
  X(IO, uchar, occluded)                    \
  X(IN, float, shadow_pool)                 \
  X(IO, i64, film)                          \
  X(OUT, float, sent_shadow_rays)           \
  X(OUT, u32, sent_counts)                  \
  X(OUT, u32, visits)

#define KDRAY_SIMD_TEST_ARGUMENTS(F, X) \
  F(IN, SimdCase, cases)                \
  X(VALUE, u32, n)                      \
  X(OUT, SimdAnswers, answers)

#ifdef __OPENCL_C_VERSION__

// A kernel's parameters: __kernel void add(KDRAY_PARAMETERS(KDRAY_ADD_ARGUMENTS)) { ... }
#define KDRAY_PARAMETERS(LIST) LIST(KDRAY_PARAMETER, KDRAY_NEXT_PARAMETER)
#define KDRAY_PARAMETER(access, type, name) KDRAY_PARAMETER_##access(type, name)
#define KDRAY_NEXT_PARAMETER(access, type, name) , KDRAY_PARAMETER_##access(type, name)
#define KDRAY_PARAMETER_IN(type, name) __global const type* in_##name
#define KDRAY_PARAMETER_OUT(type, name) __global type* out_##name
#define KDRAY_PARAMETER_IO(type, name) __global type* io_##name
#define KDRAY_PARAMETER_CONSTANT(type, name) __constant const type* name
#define KDRAY_PARAMETER_VALUE(type, name) type name

// The same parameters handed on to a function that takes them: wave_of(slice_id,
// KDRAY_HAND_ON(KDRAY_WAVE_ARGUMENTS)).
#define KDRAY_HAND_ON(LIST) LIST(KDRAY_HANDED, KDRAY_NEXT_HANDED)
#define KDRAY_HANDED(access, type, name) KDRAY_HANDED_##access(name)
#define KDRAY_NEXT_HANDED(access, type, name) , KDRAY_HANDED_##access(name)
#define KDRAY_HANDED_IN(name) in_##name
#define KDRAY_HANDED_OUT(name) out_##name
#define KDRAY_HANDED_IO(name) io_##name
#define KDRAY_HANDED_CONSTANT(name) name
#define KDRAY_HANDED_VALUE(name) name

// A group of arrays that are read, as members of a struct and as its initial value from a kernel's
// parameters.
#define KDRAY_MEMBERS(GROUP) GROUP(KDRAY_MEMBER)
#define KDRAY_MEMBER(access, type, name) __global const type* name;
#define KDRAY_MEMBERS_FROM_PARAMETERS(GROUP) \
  { GROUP(KDRAY_MEMBER_VALUE) }
#define KDRAY_MEMBER_VALUE(access, type, name) in_##name,

#endif
#endif
