// What    Shades the hits of each slice's batch: adds what needs no shadow ray, spawns reflected and refracted rays
//         into the slice's pool and shadow rays towards the lights [first_light, first_light + light_batch).
// Shape   One work-item per slice. Called once per light batch; only the first call (first_light = 0) adds and spawns.
// Source  Whitted 1980; the terms are host/scene/scene.h's Material.
// Cost    reads 64 B per ray and the primitive; writes 48 B per spawned ray and 24 B of film.
// Errors  invalid hits, NaN, and a full pool (a broken bound) are counted in the slice.
#include "film/accumulate.clh"
#include "layout/features.h"
#include "shade/light.clh"
#include "shade/secondary.clh"
#include "shade/surface.clh"

typedef struct ShadeContext {
  __constant const Frame* frame;
  __global Slice* slice;
  __global Ray* pool;
  __global ShadowRay* shadow_rays;
} ShadeContext;

#if KDRAY_HAS_REFLECT || KDRAY_HAS_TRANSMIT
inline bool spawn(const ShadeContext* c, __global const Ray* parent, float3 origin, float3 direction, float3 weight) {
  if (!c->frame->keep_weightless && !(max3(weight) > 0.0f)) return false;
  if (parent->depth >= c->frame->max_depth) {
    ++c->slice->n_skipped_depth;
    return false;
  }
  if (max3(weight) < c->frame->spawn_threshold) {
    ++c->slice->n_skipped_weight;
    return false;
  }
  if (c->slice->n_pool == c->frame->pool_size) {
    ++c->slice->n_pool_overflow;
    return false;
  }
  const Ray ray = {{origin.x, origin.y, origin.z},
                   0.0f,
                   {direction.x, direction.y, direction.z},
                   parent->depth + 1,
                   {weight.x, weight.y, weight.z},
                   parent->pixel};
  c->pool[c->slice->n_pool++] = ray;
  return true;
}

inline void spawn_secondary(const ShadeContext* c, __global const Ray* ray, const Surface* s,
                            __global const Material* material) {
  const float3 d = load3(ray->direction), weight = load3(ray->weight);
  float3 reflect = load3(material->reflect);
  bool reflects = max3(reflect) > 0.0f;
#if KDRAY_HAS_TRANSMIT
  const float3 transmit = load3(material->transmit);
  if (max3(transmit) > 0.0f) {
    reflects = reflects || c->frame->keep_weightless;
    const float eta = s->inside ? material->index : 1.0f / material->index;
    float3 direction;
    if (refracted_direction(d, s->shading, s->normal, eta, &direction)) {
      const float3 origin = offset_origin(s->point, s->point_error, -s->normal);
      if (spawn(c, ray, origin, direction, weight * transmit)) ++c->slice->n_refracted;
    } else {
      reflect += transmit;
      reflects = true;
    }
  }
#endif
  if (reflects) {
    const float3 origin = offset_origin(s->point, s->point_error, s->normal);
    const float3 direction = reflected_direction(d, s->shading, s->normal);
    if (spawn(c, ray, origin, direction, weight * reflect)) ++c->slice->n_reflected;
  }
}
#endif

#if KDRAY_HAS_LIGHTS
// The light's share in the pixel if nothing is in its way.
inline float3 lit(__global const Material* material, float3 to_light, float3 view, float3 shading, float n_dot_l) {
  float3 sum = (float3)(0.0f);
#if KDRAY_HAS_DIFFUSE
  sum = load3(material->diffuse) * n_dot_l;
#endif
#if KDRAY_HAS_SPECULAR
  const float3 mirrored = madd3(shading, 2.0f * n_dot_l, -to_light);
  const float r_dot_v = fmin(dot3(mirrored, view), 1.0f);
  if (r_dot_v > 0.0f) sum += load3(material->specular) * pow(r_dot_v, material->shine);
#endif
  return sum;
}

inline void spawn_shadow(const ShadeContext* c, __global const Ray* ray, const Hit* hit, const Surface* s,
                         __global const Material* material, __global const Light* light) {
  const Incident in = incident_light(light, s->point);
  const float n_dot_l = dot3(s->shading, in.to_light);
  if (!(n_dot_l > 0.0f)) {
    ++c->slice->n_skipped_behind;
    return;
  }
  const float3 contribution =
      load3(ray->weight) * in.color * lit(material, in.to_light, -load3(ray->direction), s->shading, n_dot_l);
  // What rounds to nothing on the film needs no ray. (NaN goes on, to be counted there.)
  if (all(contribution * KDRAY_FILM_SCALE < 0.5f) && !c->frame->keep_weightless) {
    ++c->slice->n_skipped_unlit;
    return;
  }
  const float3 origin = offset_origin(s->light_end, s->point_error, s->normal);
  const bool parallel = isinf(in.distance);
  const float3 way = parallel ? in.to_light : load3(light->position) - origin;
  // Up to the light, but for the error of a distance: a light may lie on a surface that it lights.
  const ShadowRay shadow = {{origin.x, origin.y, origin.z},
                            parallel ? INFINITY : 1.0f - 0x1p-19f,
                            {way.x, way.y, way.z},
                            s->smooth ? hit->ref : KDRAY_REF_MISS,
                            {contribution.x, contribution.y, contribution.z},
                            ray->pixel};
  c->shadow_rays[c->slice->n_shadow++] = shadow;
  ++c->slice->n_shadow_rays;
}
#endif

inline void shade_hit(const ShadeContext* c, const SurfaceArrays* arrays, __global const Material* in_materials,
                      __global const Light* in_lights, u32 first_light, __global const Ray* ray,
                      __global const Hit* in_hit, __global i64* io_film) {
  const Hit hit = *in_hit;
  if (hit.ref == KDRAY_REF_INVALID) {
    if (first_light == 0) ++c->slice->n_invalid;
    return;
  }
  if (hit.ref == KDRAY_REF_MISS) {
#if KDRAY_HAS_BACKGROUND
    if (first_light == 0)
      accumulate(c->frame, io_film, c->slice, ray->pixel, load3(ray->weight) * load3_constant(c->frame->background));
#endif
    return;
  }
  const Surface s = surface_at(arrays, load3(ray->origin), load3(ray->direction), &hit);
  __global const Material* material = in_materials + s.material;
  if (first_light == 0) {
    if (ray->depth == 1) ++c->slice->n_primary_hit;
    accumulate(c->frame, io_film, c->slice, ray->pixel, load3(ray->weight) * load3(material->unshadowed));
#if KDRAY_HAS_REFLECT || KDRAY_HAS_TRANSMIT
    spawn_secondary(c, ray, &s, material);
#endif
  }
#if KDRAY_HAS_LIGHTS
  const u32 end_light = min(first_light + c->frame->light_batch, c->frame->n_lights);
  for (u32 i = first_light; i < end_light; ++i) spawn_shadow(c, ray, &hit, &s, material, in_lights + i);
#endif
}

__kernel void shade(__global const Triangle* in_triangles, __global const VertexNormals* in_normals,
                    __global const Sphere* in_spheres, __global const Cone* in_cones,
                    __global const Material* in_materials, __global const Light* in_lights,
                    __constant const Frame* frame, u32 n_slices, u32 first_light, __global Slice* io_slices,
                    __global const Ray* in_batch, __global const Hit* in_hits, __global Ray* io_pool,
                    __global ShadowRay* out_shadow_rays, __global i64* io_film) {
  const u32 slice_id = (u32)get_global_id(0);
  if (slice_id >= n_slices) return;
  const SurfaceArrays arrays = {in_triangles, in_normals, in_spheres, in_cones};
  const ShadeContext c = {frame, io_slices + slice_id, io_pool + (size_t)slice_id * frame->pool_size,
                          out_shadow_rays + (size_t)slice_id * frame->batch_size * frame->light_batch};
  const size_t first = (size_t)slice_id * frame->batch_size;
  c.slice->n_shadow = 0;
  const u32 n_batch = c.slice->n_batch;
  for (u32 i = 0; i < n_batch; ++i)
    shade_hit(&c, &arrays, in_materials, in_lights, first_light, in_batch + first + i, in_hits + first + i, io_film);
}
