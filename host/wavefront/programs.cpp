#include "wavefront/programs.h"

#include <fmt/format.h>

#include "base/timer.h"
#include "device/opencl_error.h"
#include "layout/features.h"

namespace kdray::wavefront {

namespace {

constexpr std::uint32_t kGeometry = KDRAY_FEATURE_TRIANGLES | KDRAY_FEATURE_SPHERES | KDRAY_FEATURE_CONES;
constexpr std::uint32_t kShading = kGeometry | KDRAY_FEATURE_SMOOTH | KDRAY_FEATURE_REFLECT |
                                   KDRAY_FEATURE_TRANSMIT | KDRAY_FEATURE_SPECULAR | KDRAY_FEATURE_DIFFUSE |
                                   KDRAY_FEATURE_LIGHTS | KDRAY_FEATURE_ATTENUATION |
                                   KDRAY_FEATURE_DIRECTIONAL | KDRAY_FEATURE_SPOT | KDRAY_FEATURE_BACKGROUND;

// The bits a file reads: a scene that differs elsewhere shares the program.
std::uint32_t bits_read_by(const std::string& file) {
  if (file == "raygen/admit.cl") return KDRAY_FEATURE_SUPERSAMPLE;
  if (file == "film/add.cl") return 0;
  if (file == "film/channels.cl") return kGeometry | KDRAY_FEATURE_SMOOTH | KDRAY_FEATURE_COST;
  if (file == "shade/shade.cl") return kShading;
  return kGeometry;
}

}  // namespace

// Rounded up, so that scenes of like depth share programs.
Programs::Programs(const device::Context& context, int tree_depth)
    : context_(&context), stack_size_((tree_depth / 8 + 1) * 8) {}

std::string Programs::options_for(std::uint32_t features) const {
  std::string options =
      fmt::format("-cl-std=CL1.2 -DKDRAY_FEATURES={:#010x}u -DKDRAY_STACK_SIZE={}", features, stack_size_);
  if (context_->rounds_division_correctly()) options += " -cl-fp32-correctly-rounded-divide-sqrt";
  return options;
}

cl::Kernel Programs::kernel(const std::string& file, const std::string& name, std::uint32_t features) {
  const std::uint32_t bits = features & bits_read_by(file);
  auto found = programs_.find({file, bits});
  if (found == programs_.end()) {
    const Timer timer;
    found = programs_.emplace(std::pair{file, bits}, context_->build(file, options_for(bits))).first;
    build_seconds_ += timer.seconds();
  }
  return device::checked("making the kernel " + name,
                         [&] { return cl::Kernel(found->second, name.c_str()); });
}

}  // namespace kdray::wavefront
