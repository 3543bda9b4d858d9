#include "wavefront/programs.h"

#include <fmt/format.h>

#include <algorithm>
#include <future>
#include <string_view>

#include "base/timer.h"
#include "kernels.h"
#include "layout/features.h"
#include "layout/traversal.h"

namespace kdray::wavefront {

namespace {

constexpr layout::Features kGeometry = KDRAY_FEATURE_ALL_KINDS | KDRAY_FEATURE_NUMBERS | KDRAY_KEEP_TRACING;
constexpr layout::Features kShading =
    kGeometry | KDRAY_FEATURE_SMOOTH | KDRAY_FEATURE_REFLECT | KDRAY_FEATURE_TRANSMIT |
    KDRAY_FEATURE_SPECULAR | KDRAY_FEATURE_DIFFUSE | KDRAY_FEATURE_LIGHTS | KDRAY_FEATURE_ATTENUATION |
    KDRAY_FEATURE_DIRECTIONAL | KDRAY_FEATURE_SPOT | KDRAY_FEATURE_BACKGROUND | KDRAY_FEATURE_FACES |
    KDRAY_KEEP_SHADING;

// A wide form larger than this lies outside of the nearer caches, where fetching ahead is worth its
// instructions: a tenth is lost at 1 and 3 MB, up to a third gained at 20 MB.
constexpr std::size_t kNear = 4 << 20;

// One larger than this is a fine mesh's, outside of all caches: rays part sooner, and where packets wait for
// memory batches do something else. So they get groups that are a little less than alike (in percent; of four
// pairs). The dragon's mirror rays go 1.15 times as fast; in scenes of 38 MB and less the same costs up to a
// fifth. (64 MiB before groups, which made the dragon's form 61.)
constexpr std::size_t kFar = 48 << 20;
constexpr int kFarSpread = 5, kFarPairs = 3;

// The bits a file reads: a scene that differs elsewhere shares the program.
layout::Features bits_read_by(const std::string& file) {
  if (file == "raygen/admit.cl") return KDRAY_FEATURE_SUPERSAMPLE | KDRAY_FEATURE_ADAPTIVE;
  if (file == "film/add.cl") return 0;
  if (file == "film/channels.cl") return kGeometry | KDRAY_FEATURE_SMOOTH | KDRAY_FEATURE_COST;
  if (file == "shade/shade.cl") return kShading;
  if (file == "wave/wave.cl" || file == "odprt/wave.cl")
    return kShading | KDRAY_FEATURE_SUPERSAMPLE | KDRAY_FEATURE_ADAPTIVE;
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

// A wide node is a node of the binary tree, or below the deepest one a leaf of several kinds.
int any_order_stack_size(int tree_depth) {
  const int levels = (tree_depth / 8 + 1) * 8 + 2;
  return 7 * levels + 8;
}

// Rounded up, so that scenes of like depth share programs.
Programs::Programs(const device::Context& context, int tree_depth, const flatten::WideForm& wide,
                   std::string more_options)
    : context_(&context),
      more_options_(std::move(more_options)),
      stack_size_((tree_depth / 8 + 1) * 8),
      wide_stack_size_((wide.stack_size / 32 + 1) * 32),
      any_order_stack_size_(any_order_stack_size(tree_depth)),
      block_(wide.block),
      prefetch_(wide.bytes() > kNear),
      far_(wide.bytes() > kFar) {
  use({});
}

// What is left to the kernels' own defaults isn't named, so that their programs are the same as ever.
void Programs::use(const Tuning& t) {
  const bool prefetch = t.prefetch == 0 ? prefetch_ : t.prefetch == 2;
  walk_options_ = fmt::format(" -DKDRAY_PREFETCH={}", prefetch ? 1 : 0);
  if (t.packets > 0) walk_options_ += fmt::format(" -DKDRAY_PACKETS={}", t.packets);
  if (t.batch_rays > 0) walk_options_ += fmt::format(" -DKDRAY_BATCH_RAYS={}", t.batch_rays);
  const int spread = t.spread == 0 && far_ ? kFarSpread : t.spread;
  if (far_) walk_options_ += fmt::format(" -DKDRAY_COHERENT_PAIRS={}", kFarPairs);
  if (spread > 0) walk_options_ += fmt::format(" -DKDRAY_COHERENT_SPREAD={:.3f}f", 0.01 * spread);
  if (t.distance > 0) walk_options_ += fmt::format(" -DKDRAY_COHERENT_DISTANCE={:.4f}f", 0.001 * t.distance);
}

std::string Programs::options_for(const std::string& file, layout::Features features, Traversal traversal,
                                  Precision precision) const {
  const bool in_double = precision == Precision::float64;  // whose vectors have the portable form alone
  std::string options =
      fmt::format("-cl-std=CL1.2 -DKDRAY_FEATURES={:#018x}ul {}", features,
                  device::build_option(in_double ? device::Simd::portable : context_->simd()));
  if (in_double) options += " -DKDRAY_PRECISION=64";
  if (traversal == Traversal::binary) {
    options += fmt::format(" -DKDRAY_STACK_SIZE={}", stack_size_);
  } else {
    options += fmt::format(" -DKDRAY_TRAVERSAL={} -DKDRAY_BLOCK={} -DKDRAY_WIDE_STACK={}",
                           number_of(traversal), block_, wide_stack_size_) +
               walk_options_;
  }
  if (file == "closest/closest_points.cl")
    options += fmt::format(" -DKDRAY_CLOSEST_STACK={}", any_order_stack_size_);
  if (context_->rounds_division_correctly()) options += " -cl-fp32-correctly-rounded-divide-sqrt";
  if (!more_options_.empty()) options += " " + more_options_;
  return options;
}

std::size_t Programs::n_known() {
  const auto sources = kernels::sources();
  return static_cast<std::size_t>(std::count_if(sources.begin(), sources.end(), [](const kernels::Source& s) {
    const std::string_view name = s.name;
    return name.ends_with(".cl") && name != "common/simd_test.cl";
  }));
}

Programs::Key Programs::key_of(const Wanted& w) const {
  return {w.file, w.features & bits_read_by(w.file), w.traversal, w.precision,
          w.traversal == Traversal::binary ? std::string() : walk_options_};
}

// By a thread each: compilers work on several programs at once, and where they don't they take turns. But
// Oclgrind 21.10's are not safe in several threads, nor in another than the first: they crash.
void Programs::build(const std::vector<Wanted>& wanted) {
  const Timer timer;
  const auto when = context_->info().platform == "Oclgrind" ? std::launch::deferred : std::launch::async;
  std::map<Key, std::future<cl::Program>> building;
  for (const Wanted& w : wanted) {
    const Key key = key_of(w);
    if (programs_.contains(key) || building.contains(key)) continue;
    building.emplace(key, std::async(when, [this, key] {
                       const auto& [file, bits, traversal, precision, walk] = key;
                       return context_->build(file, options_for(file, bits, traversal, precision));
                     }));
  }
  if (building.empty()) return;
  for (auto& [key, program] : building) programs_.emplace(key, program.get());
  build_seconds_ += timer.seconds();
}

const cl::Program& Programs::program(const Wanted& wanted) {
  build({wanted});
  return programs_.at(key_of(wanted));
}

}  // namespace kdray::wavefront
