#include "wavefront/programs.h"

#include <fmt/format.h>

#include "base/timer.h"
#include "device/opencl_error.h"
#include "layout/features.h"
#include "layout/traversal.h"

namespace kdray::wavefront {

namespace {

constexpr std::uint32_t kGeometry =
    KDRAY_FEATURE_TRIANGLES | KDRAY_FEATURE_SPHERES | KDRAY_FEATURE_CONES | KDRAY_FEATURE_NUMBERS;
constexpr std::uint32_t kShading = kGeometry | KDRAY_FEATURE_SMOOTH | KDRAY_FEATURE_REFLECT |
                                   KDRAY_FEATURE_TRANSMIT | KDRAY_FEATURE_SPECULAR | KDRAY_FEATURE_DIFFUSE |
                                   KDRAY_FEATURE_LIGHTS | KDRAY_FEATURE_ATTENUATION |
                                   KDRAY_FEATURE_DIRECTIONAL | KDRAY_FEATURE_SPOT | KDRAY_FEATURE_BACKGROUND;

// A wide form larger than this lies outside of the nearer caches, where fetching ahead is worth its instructions: a tenth is lost at
// 1 and 3 MB, up to a third gained at 20 MB.
constexpr std::size_t kNear = 4 << 20;

// The bits a file reads: a scene that differs elsewhere shares the program.
std::uint32_t bits_read_by(const std::string& file) {
  if (file == "raygen/admit.cl") return KDRAY_FEATURE_SUPERSAMPLE;
  if (file == "film/add.cl") return 0;
  if (file == "film/channels.cl") return kGeometry | KDRAY_FEATURE_SMOOTH | KDRAY_FEATURE_COST;
  if (file == "shade/shade.cl") return kShading;
  if (file == "wave/wave.cl" || file == "odprt/wave.cl") return kShading | KDRAY_FEATURE_SUPERSAMPLE;
  if (file == "odprt/receive.cl") return 0;
  return kGeometry;
}

int number_of(Traversal traversal) {
  switch (traversal) {
    case Traversal::binary:
      return KDRAY_TRAVERSAL_BINARY;
    case Traversal::wide:
      return KDRAY_TRAVERSAL_WIDE;
    case Traversal::packet:
      return KDRAY_TRAVERSAL_PACKET;
    case Traversal::batch:
      return KDRAY_TRAVERSAL_BATCH;
    default:
      return KDRAY_TRAVERSAL_AUTO;
  }
}

}  // namespace

// Rounded up, so that scenes of like depth share programs.
Programs::Programs(const device::Context& context, int tree_depth, const flatten::WideForm& wide)
    : context_(&context),
      stack_size_((tree_depth / 8 + 1) * 8),
      wide_stack_size_((wide.stack_size / 32 + 1) * 32),
      block_(wide.block),
      prefetch_(wide.bytes() > kNear) {}

std::string Programs::options_for(std::uint32_t features, Traversal traversal) const {
  std::string options = fmt::format("-cl-std=CL1.2 -DKDRAY_FEATURES={:#010x}u {}", features,
                                    device::build_option(context_->simd()));
  if (traversal == Traversal::binary) {
    options += fmt::format(" -DKDRAY_STACK_SIZE={}", stack_size_);
  } else {
    options += fmt::format(" -DKDRAY_TRAVERSAL={} -DKDRAY_BLOCK={} -DKDRAY_WIDE_STACK={} -DKDRAY_PREFETCH={}",
                           number_of(traversal), block_, wide_stack_size_, prefetch_ ? 1 : 0);
  }
  if (context_->rounds_division_correctly()) options += " -cl-fp32-correctly-rounded-divide-sqrt";
  return options;
}

cl::Kernel Programs::kernel(const std::string& file, const std::string& name, std::uint32_t features,
                            Traversal traversal) {
  const std::uint32_t bits = features & bits_read_by(file);
  const std::tuple key{file, bits, traversal};
  auto found = programs_.find(key);
  if (found == programs_.end()) {
    const Timer timer;
    found = programs_.emplace(key, context_->build(file, options_for(bits, traversal))).first;
    build_seconds_ += timer.seconds();
  }
  return device::checked("making the kernel " + name,
                         [&] { return cl::Kernel(found->second, name.c_str()); });
}

}  // namespace kdray::wavefront
