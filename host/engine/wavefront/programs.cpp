#include "engine/wavefront/programs.h"

#include <fmt/format.h>

#include <algorithm>
#include <future>
#include <string_view>

#include "accel/flatten/compressed.h"
#include "base/timer.h"
#include "kernels.h"
#include "layout/features.h"
#include "layout/traversal.h"

namespace kdray::wavefront {

namespace {

// What pictures and colours at corners need. Programs that have this though they needn't would be slower.
constexpr layout::Features kTexturing = KDRAY_FEATURE_MATERIAL_MAPS | KDRAY_FEATURE_CORNER_COLORS |
                                        KDRAY_FEATURE_TEXTURES | KDRAY_FEATURE_CUTOUTS;
// What they need in shading alone.
constexpr layout::Features kLooks = kTexturing | KDRAY_FEATURE_FOOTPRINTS | KDRAY_FEATURE_METAL_MAPS |
                                    KDRAY_FEATURE_NORMAL_MAPS | KDRAY_FEATURE_LIGHT_MAPS;
// What lights with an area add to rays, and what else a scene has to have for its code to be of use.
constexpr layout::Features kSamples = KDRAY_FEATURES_NOISY;
constexpr layout::Features kGeometry = KDRAY_FEATURE_ALL_KINDS | KDRAY_FEATURE_NUMBERS |
                                       KDRAY_FEATURE_ZERO_AREA | KDRAY_FEATURE_INSTANCES | KDRAY_KEEP_TRACING;
constexpr layout::Features kShading =
    kGeometry | kLooks | KDRAY_FEATURE_SMOOTH | KDRAY_FEATURE_REFLECT | KDRAY_FEATURE_TRANSMIT |
    KDRAY_FEATURE_SPECULAR | KDRAY_FEATURE_DIFFUSE | KDRAY_FEATURE_LIGHTS | KDRAY_FEATURE_ATTENUATION |
    KDRAY_FEATURE_DIRECTIONAL | KDRAY_FEATURE_SPOT | KDRAY_FEATURE_BACKGROUND | KDRAY_FEATURE_FACES |
    KDRAY_FEATURE_SKY | KDRAY_FEATURE_FLOOR | KDRAY_FEATURE_AREA_LIGHTS | KDRAY_KEEP_SHADING;

// What sizes the plan of ODPRT's waves (odprt/choose_work.clh).
constexpr layout::Features kSizesTravel =
    KDRAY_FEATURE_REFLECT | KDRAY_FEATURE_TRANSMIT | KDRAY_FEATURE_LIGHTS;

// A wide form larger than this lies outside of the nearer caches, where fetching ahead is worth its
// instructions: a tenth is lost at 1 and 3 MB, up to a third gained at 20 MB.
constexpr std::size_t kNear = 4 << 20;

// One larger than this is a fine mesh's, outside of all caches: rays part sooner, and where packets wait for
// memory batches do something else. So sixteen rays have to be more alike there to be a packet: in so many of
// four pairs the directions differ by so many percent at most. The dragon's mirror rays go 1.15 times as
// fast; in scenes of 38 MB and less the same costs up to a fifth.
constexpr std::size_t kFar = 48 << 20;
constexpr int kFarSpread = 5, kFarPairs = 3;

// The bits a file reads: a scene that differs elsewhere shares the program.
layout::Features bits_read_by(const std::string& file) {
  if (file == "traverse/query.cl" || file == "traverse/collect.cl")
    return kGeometry | KDRAY_FEATURE_MASKS | KDRAY_FEATURE_FILTER;
  if (file == "wave/plan.cl") return KDRAY_FEATURE_ADAPTIVE;
  if (file == "odprt/stages/plan.cl") return KDRAY_FEATURE_ADAPTIVE | kSizesTravel;
  if (file == "raygen/admit.cl" || file == "odprt/stages/admit.cl")
    return KDRAY_FEATURE_SUPERSAMPLE | KDRAY_FEATURE_ADAPTIVE | KDRAY_FEATURE_FOOTPRINTS | kSamples |
           KDRAY_FEATURE_INSTANCES;
  if (file == "film/add.cl") return KDRAY_FEATURE_INSTANCES;
  if (file == "film/channels.cl") return kGeometry | kTexturing | KDRAY_FEATURE_SMOOTH | KDRAY_FEATURE_COST;
  if (file == "shade/shade.cl" || file == "odprt/stages/shade.cl") return kShading;
  if (file == "wave/wave.cl")
    return kShading | KDRAY_FEATURE_SUPERSAMPLE | KDRAY_FEATURE_ADAPTIVE | kSamples | KDRAY_KEEP_EMPTY;
  if (file == "odprt/wave.cl")
    return kShading | KDRAY_FEATURE_SUPERSAMPLE | KDRAY_FEATURE_ADAPTIVE | kSamples;
  if (file == "odprt/receive.cl" || file == "odprt/stages/receive.cl")
    return KDRAY_FEATURE_FOOTPRINTS | KDRAY_FEATURE_AREA_LIGHTS | KDRAY_FEATURE_INSTANCES;
  if (file == "traverse/trace_closest.cl" || file == "odprt/stages/trace.cl")
    return kGeometry | kTexturing | KDRAY_FEATURE_FOOTPRINTS | KDRAY_FEATURE_AREA_LIGHTS;
  if (file == "traverse/trace_shadow.cl" || file == "odprt/stages/shadow.cl") return kGeometry | kTexturing;
  return kGeometry;
}

// The bits that a file's program may have though they are not wanted: not the rules that are off, by which
// rays are counted; not masks, which a scene has to have, nor a filter, nor textures, whose arrays would be
// read, nor what changes the form of rays or where they start; and not in ODPRT what sizes its plan
// (odprt/choose_work.clh).
layout::Features spare_bits_of(const std::string& file) {
  layout::Features bits = bits_read_by(file) & ~(KDRAY_KEEP_ALL | KDRAY_FEATURE_MASKS | KDRAY_FEATURE_FILTER |
                                                 kLooks | kSamples | KDRAY_FEATURE_INSTANCES);
  if (file == "odprt/wave.cl" || file == "odprt/stages/plan.cl") bits &= ~kSizesTravel;
  return bits;
}

// A program with a larger stack serves as well. Sizes are rounded up, so that scenes of like depth share
// programs.
constexpr int kBinaryStacks = 8, kLargestBinaryStack = 64, kWideStacks = 32, kLeastWideStack = 64,
              kLargestWideStack = 128, kWideLevels = 16;

int rounded_up(int stack, int step) {
  return (stack / step + 1) * step;
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

void ProgramsUsed::add(const ProgramsUsed& other) {
  compiled += other.compiled, found += other.found, covering += other.covering;
  spare |= other.spare;
}

Programs::Programs(const device::Context& context, const TreeForm& form, std::string more_options)
    : context_(&context),
      more_options_(std::move(more_options)),
      stack_size_(rounded_up(form.depth, kBinaryStacks)),
      wide_stack_size_(std::max(rounded_up(form.stack, kWideStacks), kLeastWideStack)),
      any_order_stack_size_(any_order_stack_size(form.depth)),
      block_(form.block),
      widen_(form.widen),
      prefetch_(form.bytes > kNear),
      far_(form.bytes > kFar),
      queries_alone_(context.info().kind != "cpu") {
  use({});
}

Programs::Programs(const device::Context& context, int tree_depth, const flatten::WideForm& wide,
                   std::string more_options)
    : Programs(context,
               TreeForm{.depth = tree_depth,
                        .widen = wide.widen,
                        .stack = wide.stack_size,
                        .block = wide.block,
                        .bytes = wide.bytes()},
               std::move(more_options)) {
  nodes_ = wide.nodes;
}

// Large trees are deep ones.
std::vector<Programs::UsualForm> Programs::usual_forms() {
  const std::size_t near_mib = kNear >> 20, far_mib = kFar >> 20;
  std::vector<UsualForm> forms;
  for (const int block : {4, 8}) {
    const auto add = [&](int stack, std::size_t bytes, const std::string& size) {
      forms.push_back({{.depth = kLargestBinaryStack - 1, .stack = stack, .block = block, .bytes = bytes},
                       fmt::format("scenes of {}, in blocks of {}", size, block)});
    };
    add(63, 0, fmt::format("up to {} MiB", near_mib));
    add(95, kNear + 1, fmt::format("{} to {} MiB", near_mib, far_mib));
    add(127, kFar + 1, fmt::format("over {} MiB", far_mib));
  }
  return forms;
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

bool Programs::walks_alone(const std::string& file, Traversal traversal) const {
  const bool is_stage = file == "traverse/trace_closest.cl" || file == "traverse/trace_shadow.cl" ||
                        file == "odprt/stages/trace.cl" || file == "odprt/stages/shadow.cl";
  return traversal == Traversal::wide && (is_stage || (queries_alone_ && file == "traverse/query.cl"));
}

std::string Programs::options_for(const std::string& file, Traversal traversal, Precision precision,
                                  int stack) const {
  const bool in_double = precision == Precision::float64;  // double has only the portable vector form
  std::string options =
      "-cl-std=CL1.2 " + device::build_option(in_double ? device::Simd::portable : context_->simd());
  if (in_double) options += " -DKDRAY_PRECISION=64";
  if (walks_alone(file, traversal)) {
    options += fmt::format(" -DKDRAY_WIDE_LEVELS={}", levels_);
    if (file == "traverse/query.cl") options += " -DKDRAY_LANES=1u";
  }
  if (traversal == Traversal::binary) {
    options += fmt::format(" -DKDRAY_STACK_SIZE={}", stack);
  } else {
    options += fmt::format(" -DKDRAY_TRAVERSAL={} -DKDRAY_BLOCK={} -DKDRAY_WIDE_STACK={}",
                           number_of(traversal), block_, stack) +
               walk_options_;
  }
  if (widen_ > 1) options += fmt::format(" -DKDRAY_PAD={}*0x1p-19f", widen_);
  if (file == "closest/closest_points.cl")
    options += fmt::format(" -DKDRAY_CLOSEST_STACK={}", any_order_stack_size_);
  if (context_->rounds_division_correctly()) options += " -cl-fp32-correctly-rounded-divide-sqrt";
  if (!more_options_.empty()) options += " " + more_options_;
  return options;
}

device::Variant Programs::variant_for(const Key& key) const {
  const auto& [file, bits, traversal, precision, walk] = key;
  const bool binary = traversal == Traversal::binary;
  const int stack = binary ? stack_size_ : wide_stack_size_;
  device::Variant variant{
      .options = options_for(file, traversal, precision, stack), .mask = bits, .spare = spare_bits_of(file)};
  const int step = binary ? kBinaryStacks : kWideStacks;
  for (int larger = stack + step; larger <= (binary ? kLargestBinaryStack : kLargestWideStack);
       larger += step)
    variant.instead.push_back(options_for(file, traversal, precision, larger));
  return variant;
}

std::size_t Programs::n_known() {
  const auto sources = kernels::sources();
  return static_cast<std::size_t>(std::count_if(sources.begin(), sources.end(), [](const kernels::Source& s) {
    const std::string_view name = s.name;
    return name.ends_with(".cl") && name != "common/simd_test.cl";
  }));
}

Programs::Key Programs::key_of(const Wanted& w) const {
  const layout::Features wanted = w.features | (everything_ ? spare_bits_of(w.file) : 0);
  return {w.file, wanted & bits_read_by(w.file), w.traversal, w.precision,
          w.traversal == Traversal::binary ? std::string() : walk_options_};
}

// By a thread each: compilers work on several programs at once, and where they don't they take turns. But
// Oclgrind 21.10's are not safe in several threads, nor in another than the first: they crash.
void Programs::build(const std::vector<Wanted>& wanted) {
  const std::lock_guard lock(mutex_);
  const Timer timer;
  const auto when = context_->info().platform == "Oclgrind" ? std::launch::deferred : std::launch::async;
  std::map<Key, std::future<device::BuiltVariant>> building;
  for (const Wanted& w : wanted) {
    const Key key = key_of(w);
    if (programs_.contains(key) || building.contains(key)) continue;
    if (walks_alone(w.file, w.traversal) && levels_ == 0)
      levels_ = rounded_up(flatten::most_levels(nodes_), kWideLevels);
    building.emplace(
        key, std::async(when, [this, key] { return context_->build(std::get<0>(key), variant_for(key)); }));
  }
  if (building.empty()) return;
  for (auto& [key, future] : building) {
    const device::BuiltVariant built = future.get();
    const layout::Features spare = built.mask & ~std::get<1>(key);
    used_.add({.compiled = built.compiled,
               .found = !built.compiled && spare == 0,
               .covering = !built.compiled && spare != 0,
               .spare = spare});
    programs_.emplace(key, built.program);
  }
  build_seconds_ += timer.seconds();
}

bool Programs::are_new(const Launches& launches) const {
  const std::lock_guard lock(mutex_);
  return !launched_.contains({walk_options_, everything_, launches});
}

void Programs::were_launched(const Launches& launches) {
  const std::lock_guard lock(mutex_);
  launched_.emplace(walk_options_, everything_, launches);
}

const cl::Program& Programs::program(const Wanted& wanted) {
  build({wanted});
  const std::lock_guard lock(mutex_);
  return programs_.at(key_of(wanted));
}

}  // namespace kdray::wavefront
