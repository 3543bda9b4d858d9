// The streams as the traversals get them, from a batch made by hand: shadow rays light by light, without gaps
// and in the batch's order; spawned rays in the pool of their depth, sixteen hits' refracted rays before
// their reflected ones; and nothing written beyond a stream's capacity. For batches around multiples of
// sixteen.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numeric>
#include <tuple>

#include "device/opencl/context.h"
#include "layout/features.h"
#include "layout/frame.layout.h"
#include "layout/primitives.layout.h"
#include "layout/rays.layout.h"
#include "layout/shading.layout.h"
#include "layout/tree.layout.h"
#include "support/device.h"

namespace kdray::wavefront {
namespace {

constexpr cl_uint kManyLights = 4, kBehind = 1,
                  kDark = 2;     // one light is below the floor, one gives no light
constexpr float kGuard = 12345;  // behind the streams

// Shading by one work-item for all rays, sixteen at a time, or by one for each ray.
enum class Form { slice, per_ray };

const char* const kOfSlice = R"(
#include "layout/arguments.h"
#include "shade/shade.clh"
__kernel void shade(KDRAY_PARAMETERS(KDRAY_SHADE_ARGUMENTS)) {
  const SurfaceArrays arrays = KDRAY_MEMBERS_FROM_PARAMETERS(KDRAY_SURFACE_ARRAYS);
  const TexturingArrays texturing = KDRAY_MEMBERS_FROM_PARAMETERS(KDRAY_TEXTURING_ARRAYS);
  const SkyArrays sky = KDRAY_MEMBERS_FROM_PARAMETERS(KDRAY_SKY_ARRAYS);
  shade_batch(&arrays, &texturing, &sky, in_lights, frame, 0, first_light, io_slices, in_batch, in_hits,
              io_pool, out_shadow_rays, io_film);
})";

// A stream's words, read back.
struct Words {
  std::vector<float> words;
  cl_uint capacity;

  float at(cl_uint field, cl_uint ray) const { return words[std::size_t{field} * capacity + ray]; }
  cl_uint bits(cl_uint field, cl_uint ray) const { return std::bit_cast<cl_uint>(at(field, ray)); }
};

// Rays straight down onto a floor of tinted glass at z = 0, from above the pixel's place. Every fifth one
// misses.
class Batch {
 public:
  Batch(const std::string& device, cl_uint n, cl_uint capacity) : context_(device, 1), n_(n) {
    frame_.width = 1024;
    frame_.height = 1;
    frame_.max_depth = 3;
    frame_.n_lights = frame_.light_batch = kManyLights;
    frame_.batch_size = n;
    frame_.batch_capacity = capacity;
    frame_.pool_size = 3 * n;
    frame_.pool_capacity = 3 * capacity;
    frame_.shadow_capacity = kManyLights * capacity;
    frame_.background[1] = 0.5f;
    slice_.depth = 1;
    slice_.n_batch = n;
  }

  static bool hits(cl_uint ray) { return ray % 5 != 4; }
  static cl_uint pixel(cl_uint ray) { return 3 * ray + 1; }
  cl_uint n_hits() const { return n_ - n_ / 5; }

  void shade(Form form) {
    const auto upload = [&](const void* data, std::size_t bytes) {
      cl::Buffer buffer = context_.buffer(CL_MEM_READ_WRITE, bytes, "test data");
      context_.queues().front().enqueueWriteBuffer(buffer, CL_TRUE, 0, bytes, data);
      return buffer;
    };
    const auto guarded = [&](std::size_t words) { return std::vector<float>(words + 16, kGuard); };
    const layout::Triangle floor{{{-1e4f, -1e4f, 0}, {1e4f, -1e4f, 0}, {0, 2e4f, 0}}, 0, 0, KDRAY_NO_NORMALS};
    const layout::Material glass{{0.1f, 0.1f, 0.1f},
                                 {0.5f, 0.5f, 0.5f},
                                 {0.2f, 0.2f, 0.2f},
                                 {0.25f, 0.25f, 0.25f},
                                 {0.5f, 0.4f, 0.3f},
                                 10,
                                 1.5f,
                                 KDRAY_NO_MAPS,
                                 {}};
    std::array<layout::Light, kManyLights> lights{};
    for (cl_uint k = 0; k < kManyLights; ++k) {
      lights[k].attenuation[0] = 1;
      lights[k].range = INFINITY;
      lights[k].position[0] = light_x(k);
      lights[k].position[2] = k == kBehind ? -100.0f : 100.0f;
      if (k != kDark) lights[k].color[0] = static_cast<float>(k + 1);
    }
    std::vector<float> batch = guarded(std::size_t{KDRAY_RAY_FIELDS} * frame_.batch_capacity),
                       hits_found = guarded(std::size_t{KDRAY_HIT_FIELDS} * frame_.batch_capacity);
    const auto set = [&](std::vector<float>& stream, cl_uint field, cl_uint i, float v) {
      stream[std::size_t{field} * frame_.batch_capacity + i] = v;
    };
    for (cl_uint i = 0; i < n_; ++i) {
      const float ray[KDRAY_RAY_FIELDS] = {static_cast<float>(pixel(i)),
                                           0,
                                           1,
                                           0,
                                           0,
                                           -1,
                                           0,
                                           INFINITY,
                                           1,
                                           0.5f,
                                           0.25f,
                                           std::bit_cast<float>(pixel(i)),
                                           std::bit_cast<float>(KDRAY_REF_MISS)};
      for (cl_uint f = 0; f < KDRAY_RAY_FIELDS; ++f) set(batch, f, i, ray[f]);
      const float u = ray[0] / 2e4f, v = 0.5f;  // not where the ray meets the floor; any place on it will do
      const float hit[KDRAY_HIT_FIELDS] = {1, std::bit_cast<float>(hits(i) ? 0u : KDRAY_REF_MISS), u, v};
      for (cl_uint f = 0; f < KDRAY_HIT_FIELDS; ++f) set(hits_found, f, i, hit[f]);
    }
    pool.capacity = frame_.pool_capacity;
    pool.words = guarded(std::size_t{KDRAY_POOL_FIELDS} * 2 * pool.capacity);
    shadow.capacity = frame_.shadow_capacity;
    shadow.words = guarded(std::size_t{KDRAY_SHADOW_FIELDS} * shadow.capacity);
    film.assign(std::size_t{frame_.width} * 3, 0);

    const cl::Buffer none = context_.buffer(CL_MEM_READ_WRITE, 0, "nothing"),
                     frame = upload(&frame_, sizeof frame_), slice = upload(&slice_, sizeof slice_),
                     floors = upload(&floor, sizeof floor), glasses = upload(&glass, sizeof glass),
                     lamps = upload(lights.data(), sizeof lights),
                     rays = upload(batch.data(), batch.size() * 4),
                     found = upload(hits_found.data(), hits_found.size() * 4),
                     pooled = upload(pool.words.data(), pool.words.size() * 4),
                     shadows = upload(shadow.words.data(), shadow.words.size() * 4),
                     sums = upload(film.data(), film.size() * sizeof(layout::i64));
    using K = kernels::Shade;
    // Everything but what would give rays another word, and read more arrays.
    const std::string options =
        "-cl-std=CL1.2 " + device::build_option(context_.simd()) +
        fmt::format(" -DKDRAY_FEATURES={}ul",
                    ~(KDRAY_KEEP_ALL | KDRAY_FEATURE_SKY | KDRAY_FEATURE_AREA_LIGHTS | KDRAY_FEATURE_CUTOUTS |
                      KDRAY_FEATURE_INSTANCES | KDRAY_FEATURE_FOOTPRINTS));
    device::Kernel<K> kernel(form == Form::per_ray ? context_.build(K::kFile, options)
                                                   : context_.build_text("slice.cl", kOfSlice, options));
#define KDRAY_SET_NONE(access, type, name) kernel.set(K::name, none);
    KDRAY_SURFACE_ARRAYS(KDRAY_SET_NONE)
    KDRAY_TEXTURING_ARRAYS(KDRAY_SET_NONE)
    KDRAY_SKY_ARRAYS(KDRAY_SET_NONE)
#undef KDRAY_SET_NONE
    kernel.set(K::triangles, floors).set(K::materials, glasses).set(K::lights, lamps).set(K::frame, frame);
    kernel.set(K::first_light, cl_uint{0}).set(K::slices, slice);
    kernel.set(K::batch, rays).set(K::hits, found).set(K::pool, pooled).set(K::shadow_rays, shadows);
    kernel.set(K::film, sums);
    const cl::CommandQueue& queue = context_.queues().front();
    constexpr cl_uint kGroup = 8;
    const cl::NDRange items(form == Form::per_ray ? (n_ + kGroup - 1) / kGroup * kGroup : 1);
    queue.enqueueNDRangeKernel(kernel.ready(), cl::NullRange, items,
                               cl::NDRange(form == Form::per_ray ? kGroup : 1));
    queue.enqueueReadBuffer(slice, CL_TRUE, 0, sizeof slice_, &slice_);
    queue.enqueueReadBuffer(pooled, CL_TRUE, 0, pool.words.size() * 4, pool.words.data());
    queue.enqueueReadBuffer(shadows, CL_TRUE, 0, shadow.words.size() * 4, shadow.words.data());
    queue.enqueueReadBuffer(sums, CL_TRUE, 0, film.size() * sizeof(layout::i64), film.data());
    if (form == Form::per_ray) put_in_order();
  }

  static float light_x(cl_uint k) {
    return 10.0f * static_cast<float>(k) - 5;
  }
  const layout::Slice& slice() const {
    return slice_;
  }

  Words pool, shadow;
  std::vector<layout::i64> film;

 private:
  // As slices have them: shadow rays without the places that have no ray, and the pool's rays, which come in
  // any order.
  void put_in_order() {
    const auto move = [](Words& words, cl_uint n_fields, const std::vector<cl_uint>& from) {
      const Words before = words;
      for (cl_uint f = 0; f < n_fields; ++f)
        for (cl_uint i = 0; i < from.size(); ++i)
          words.words[std::size_t{f} * words.capacity + i] = before.at(f, from[i]);
    };
    std::vector<cl_uint> rays;
    for (cl_uint light = 0; light < kManyLights; ++light)
      for (cl_uint ray = 0; ray < n_; ++ray)
        if (shadow.at(KDRAY_RAY_T_MAX, light * frame_.batch_capacity + ray) >= 0)
          rays.push_back(light * frame_.batch_capacity + ray);
    move(shadow, KDRAY_SHADOW_FIELDS, rays);
    slice_.n_shadow = static_cast<cl_uint>(rays.size());
    Words second = pool;  // of the rays of depth 2, which come first
    std::vector<cl_uint> pooled(slice_.n_pool[1]);
    std::iota(pooled.begin(), pooled.end(), 0u);
    const auto place = [&](cl_uint i) {
      const cl_uint ray = (second.bits(KDRAY_POOL_PIXEL, i) - 1) / 3;
      return std::tuple(ray / 16, second.at(KDRAY_POOL_DIRECTION + 2, i) > 0, ray);
    };
    std::ranges::sort(pooled, {}, place);
    move(pool, KDRAY_POOL_FIELDS, pooled);
  }

  device::Context context_;
  cl_uint n_;
  layout::Frame frame_{};
  layout::Slice slice_{};
};

class StreamsTest : public test::EachDevice {
 protected:
  // The smallest capacity that a batch of n may have, and a roomier one.
  template <class Check>
  void for_each_batch(Check check) {
    for (const cl_uint n : {1u, 5u, 15u, 16u, 17u, 32u, 37u, 100u})
      for (const cl_uint capacity : {(n + 31) / 16 * 16, (n + 31) / 16 * 16 + 48}) {
        SCOPED_TRACE("batch of " + std::to_string(n) + ", capacity " + std::to_string(capacity));
        for (const Form form : {Form::slice, Form::per_ray}) {
          SCOPED_TRACE(form == Form::slice ? "a slice" : "a work-item for each ray");
          Batch batch(GetParam(), n, capacity);
          batch.shade(form);
          check(batch, n);
        }
      }
  }
};

TEST_P(StreamsTest, ShadowRaysComeLightByLightWithoutGaps) {
  for_each_batch([](const Batch& batch, cl_uint n) {
    EXPECT_EQ(batch.slice().n_shadow, batch.n_hits() * 2);
    EXPECT_EQ(batch.slice().n_shadow_rays, batch.n_hits() * 2);
    EXPECT_EQ(batch.slice().n_skipped_behind, batch.n_hits());
    EXPECT_EQ(batch.slice().n_skipped_unlit, batch.n_hits());
    cl_uint i = 0;
    for (const cl_uint light : {0u, 3u}) {
      for (cl_uint ray = 0; ray < n; ++ray) {
        if (!Batch::hits(ray)) continue;
        const Words& s = batch.shadow;
        ASSERT_EQ(s.bits(KDRAY_SHADOW_PIXEL, i), Batch::pixel(ray)) << i;
        const float end_x = s.at(KDRAY_RAY_ORIGIN, i) + s.at(KDRAY_RAY_DIRECTION, i);
        ASSERT_NEAR(end_x, Batch::light_x(light), 0.01f) << i;
        ASSERT_NEAR(s.at(KDRAY_RAY_ORIGIN + 2, i) + s.at(KDRAY_RAY_DIRECTION + 2, i), 100, 0.01f) << i;
        ASSERT_EQ(s.at(KDRAY_RAY_T_MIN, i), 0) << i;
        ASSERT_LT(s.at(KDRAY_RAY_T_MAX, i), 1) << i;
        ASSERT_GT(s.at(KDRAY_RAY_T_MAX, i), 0.99999f) << i;
        ASSERT_EQ(s.bits(KDRAY_SHADOW_SKIP, i), 0u) << i;  // the floor, which they leave
        ASSERT_GT(s.at(KDRAY_SHADOW_CONTRIBUTION, i), 0) << i;
        ASSERT_EQ(s.at(KDRAY_SHADOW_CONTRIBUTION + 1, i), 0) << i;  // the lights are red
        ++i;
      }
    }
  });
}

TEST_P(StreamsTest, SpawnedRaysLieInThePoolOfTheirDepth) {
  for_each_batch([](const Batch& batch, cl_uint n) {
    EXPECT_EQ(batch.slice().n_pool[0], 0u);
    EXPECT_EQ(batch.slice().n_pool[1], 2 * batch.n_hits());
    EXPECT_EQ(batch.slice().n_pool[2], 0u);
    EXPECT_EQ(batch.slice().n_refracted, batch.n_hits());
    EXPECT_EQ(batch.slice().n_reflected, batch.n_hits());
    cl_uint i = 0;
    for (cl_uint first = 0; first < n; first += 16) {
      for (const float down : {-1.0f, 1.0f}) {  // refracted, reflected
        for (cl_uint ray = first; ray < std::min(first + 16, n); ++ray) {
          if (!Batch::hits(ray)) continue;
          const Words& p = batch.pool;
          ASSERT_EQ(p.bits(KDRAY_POOL_PIXEL, i), Batch::pixel(ray)) << i;
          ASSERT_EQ(p.bits(KDRAY_POOL_SKIP, i), 0u) << i;  // the floor
          ASSERT_NEAR(p.at(KDRAY_POOL_DIRECTION + 2, i), down, 1e-6f) << i;
          ASSERT_EQ(p.at(KDRAY_POOL_WEIGHT, i), down < 0 ? 0.5f : 0.25f) << i;
          ASSERT_EQ(p.at(KDRAY_POOL_WEIGHT + 1, i), 0.5f * (down < 0 ? 0.4f : 0.25f)) << i;
          ++i;
        }
      }
    }
  });
}

TEST_P(StreamsTest, NothingIsWrittenBeyondThem) {
  for_each_batch([](const Batch& batch, cl_uint) {
    for (const Words* stream : {&batch.pool, &batch.shadow})
      for (std::size_t i = stream->words.size() - 16; i < stream->words.size(); ++i)
        ASSERT_EQ(stream->words[i], kGuard);
  });
}

TEST_P(StreamsTest, TheFilmGetsWhatNeedsNoShadowRay) {
  for_each_batch([](const Batch& batch, cl_uint n) {
    const float weight[3] = {1, 0.5f, 0.25f};
    const float background[3] = {0, 0.5f, 0};
    std::vector<layout::i64> wanted(batch.film.size(), 0);
    for (cl_uint ray = 0; ray < n; ++ray)
      for (cl_uint c = 0; c < 3; ++c)
        wanted[Batch::pixel(ray) * 3 + c] = static_cast<layout::i64>(
            weight[c] * (Batch::hits(ray) ? 0.1f : background[c]) * KDRAY_FILM_SCALE);
    EXPECT_EQ(batch.film, wanted);
    EXPECT_EQ(batch.slice().n_primary_hit, batch.n_hits());
    EXPECT_EQ(batch.slice().n_nan + batch.slice().n_invalid + batch.slice().n_pool_overflow, 0u);
  });
}

KDRAY_FOR_EACH_DEVICE(StreamsTest);

}  // namespace
}  // namespace kdray::wavefront
