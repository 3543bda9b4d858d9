// The structs of kernels/layout have the same size and offsets on the host and on each device: a kernel
// writes its own back. (Both compilers assert sizes as well; this covers a device compiler that would ignore
// the assertions.)
#include <gtest/gtest.h>

#include "device/opencl/context.h"
#include "layout/closest.layout.h"
#include "layout/frame.layout.h"
#include "layout/kinds.h"
#include "layout/primitives.layout.h"
#include "layout/rays.layout.h"
#include "layout/shading.layout.h"
#include "layout/simd_test.layout.h"
#include "layout/sky.layout.h"
#include "layout/textures.layout.h"
#include "layout/tree.layout.h"
#include "layout/verify.layout.h"
#include "layout/wide.layout.h"
#include "support/device.h"

namespace kdray::layout {
namespace {

struct Probe {
  std::string expression;  // as the device evaluates it
  std::size_t host;
};

#define SIZE(type)                    \
  Probe {                             \
    "sizeof(" #type ")", sizeof(type) \
  }
#define OFFSET(type, field)                                            \
  Probe {                                                              \
    "__builtin_offsetof(" #type ", " #field ")", offsetof(type, field) \
  }

// These are of each kind of primitive.
#define PRIMITIVE(NAME, name, names, Struct) SIZE(Struct), OFFSET(Struct, number), OFFSET(Struct, material),

const std::vector<Probe> kProbes = {KDRAY_KINDS(PRIMITIVE) SIZE(KdNode),
                                    SIZE(VertexNormals),
                                    SIZE(Material),
                                    SIZE(Light),
                                    SIZE(MaterialMaps),
                                    SIZE(Texture),
                                    SIZE(CornerColors),
                                    SIZE(TexCoords),
                                    OFFSET(MaterialMaps, how),
                                    OFFSET(Texture, how),
                                    SIZE(Sky),
                                    OFFSET(Sky, height),
                                    OFFSET(Light, across),
                                    OFFSET(Light, down),
                                    OFFSET(Frame, lens_radius),
                                    OFFSET(Frame, tells_sample),
                                    SIZE(QueryRay),
                                    SIZE(QueryHit),
                                    SIZE(QueryPoint),
                                    SIZE(ClosestHit),
                                    SIZE(Frame),
                                    SIZE(Slice),
                                    SIZE(WideNode),
                                    SIZE(Departure),
                                    SIZE(SimdCase),
                                    SIZE(SimdAnswers),
                                    OFFSET(KdNode, word1),
                                    OFFSET(Triangle, v),
                                    OFFSET(Triangle, normals),
                                    OFFSET(Sphere, radius),
                                    OFFSET(Cone, base_radius),
                                    OFFSET(Cone, axis),
                                    OFFSET(Cone, height),
                                    OFFSET(Cone, slope),
                                    OFFSET(Disc, radius),
                                    OFFSET(Disc, normal),
                                    OFFSET(Torus, major_radius),
                                    OFFSET(Torus, axis),
                                    OFFSET(Torus, minor_radius),
                                    OFFSET(Material, diffuse),
                                    OFFSET(Material, specular),
                                    OFFSET(Material, reflect),
                                    OFFSET(Material, transmit),
                                    OFFSET(Material, shine),
                                    OFFSET(Material, index),
                                    OFFSET(Light, kind),
                                    OFFSET(Light, direction),
                                    OFFSET(Light, range),
                                    OFFSET(Light, color),
                                    OFFSET(Light, cos_inner),
                                    OFFSET(Light, attenuation),
                                    OFFSET(Light, cos_outer),
                                    OFFSET(QueryRay, t_min),
                                    OFFSET(QueryRay, direction),
                                    OFFSET(QueryRay, t_max),
                                    OFFSET(QueryHit, primitive),
                                    OFFSET(QueryHit, u),
                                    OFFSET(ClosestHit, distance),
                                    OFFSET(ClosestHit, u),
                                    OFFSET(ClosestHit, number),
                                    OFFSET(ClosestHit, form),
                                    OFFSET(Frame, hither),
                                    OFFSET(Frame, forward),
                                    OFFSET(Frame, x_scale),
                                    OFFSET(Frame, right),
                                    OFFSET(Frame, up),
                                    OFFSET(Frame, background),
                                    OFFSET(Frame, root_lo),
                                    OFFSET(Frame, world_max),
                                    OFFSET(Frame, root_hi),
                                    OFFSET(Frame, spawn_threshold),
                                    OFFSET(Frame, width),
                                    OFFSET(Frame, tile_width),
                                    OFFSET(Frame, n_tiles_x),
                                    OFFSET(Frame, n_samples),
                                    OFFSET(Frame, max_depth),
                                    OFFSET(Frame, corner_grid),
                                    OFFSET(Frame, batch_size),
                                    OFFSET(Frame, pool_size),
                                    OFFSET(Frame, light_batch),
                                    OFFSET(Frame, first_pixel),
                                    OFFSET(Frame, batch_capacity),
                                    OFFSET(Frame, pool_capacity),
                                    OFFSET(Frame, shadow_capacity),
                                    OFFSET(Frame, keep_weightless),
                                    OFFSET(Frame, open_lights),
                                    OFFSET(Frame, core_lo),
                                    OFFSET(Frame, face_lo),
                                    OFFSET(Frame, face_hi),
                                    OFFSET(Frame, floor_radius),
                                    OFFSET(Frame, floor_diffuse),
                                    OFFSET(Slice, n_pool),
                                    OFFSET(Slice, n_shadow),
                                    OFFSET(Slice, tile_stride),
                                    OFFSET(Slice, n_waves),
                                    OFFSET(Slice, n_primary),
                                    OFFSET(Slice, n_pool_overflow),
                                    OFFSET(Slice, n_skipped_open),
                                    OFFSET(Slice, n_skipped_background),
                                    OFFSET(Slice, next_place),
                                    OFFSET(Slice, depth),
                                    OFFSET(WideNode, child),
                                    OFFSET(WideNode, order),
                                    OFFSET(SimdCase, index),
                                    OFFSET(SimdCase, mask),
                                    OFFSET(SimdAnswers, select16),
                                    OFFSET(SimdAnswers, permuteu8)};

class LayoutTest : public test::EachDevice {};

TEST_P(LayoutTest, TheDeviceSeesTheSameStructs) {
  std::string source;
  for (const char* header : {"closest", "frame", "textures", "primitives", "rays", "shading", "simd_test",
                             "sky", "tree", "verify", "wide"})
    source += "#include \"layout/" + std::string(header) + ".layout.h\"\n";
  source += "__kernel void probe(__global uint* out) {\n";
  for (std::size_t i = 0; i < kProbes.size(); ++i)
    source += "out[" + std::to_string(i) + "] = (uint)" + kProbes[i].expression + ";\n";
  source += "}\n";

  const device::Context context(GetParam(), 1);
  cl::Kernel kernel(context.build_text("layout_probe.cl", source, "-cl-std=CL1.2"), "probe");
  const cl::Buffer out = context.buffer(CL_MEM_WRITE_ONLY, kProbes.size() * sizeof(cl_uint), "the probes");
  kernel.setArg(0, out);
  const cl::CommandQueue& queue = context.queues().front();
  queue.enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(1));
  std::vector<cl_uint> device(kProbes.size());
  queue.enqueueReadBuffer(out, CL_TRUE, 0, device.size() * sizeof(cl_uint), device.data());
  for (std::size_t i = 0; i < kProbes.size(); ++i)
    EXPECT_EQ(device[i], kProbes[i].host) << kProbes[i].expression;
}

KDRAY_FOR_EACH_DEVICE(LayoutTest);

}  // namespace
}  // namespace kdray::layout
