#include "probe/selftest/self_test.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <mutex>
#include <optional>

#include "accel/prepare/prepared.h"
#include "device/opencl/opencl_error.h"
#include "device/opencl/program.h"
#include "device/opencl/program_cache.h"
#include "engine/query/trace.h"

namespace kdray::selftest {

namespace {

constexpr int kAcross = 8, kDown = 6;

constexpr std::array kAnswers = std::to_array<Answer>({
#include "probe/selftest/known_answers.inc"
});
static_assert(kAnswers.size() == kAcross * kDown);

}  // namespace

scene::Scene known_scene() {
  scene::Scene scene;
  scene.name = "self-test";
  scene.materials = {scene::Material{.ambient = vec3(0.1f), .diffuse = vec3(0.8f)}};
  scene.vertices = {{-3, -2, -2}, {3, -2, -1}, {3, 2, -1.5}, {-3, 2, -2.5}};
  scene.triangles = {scene::Triangle{.vertex = {0, 1, 2}, .material = 0, .number = 0},
                     scene::Triangle{.vertex = {0, 2, 3}, .material = 0, .number = 1}};
  scene.spheres = {scene::Sphere{.center = {-1.1, 0.2, 0.3}, .radius = 0.9, .material = 0, .number = 2}};
  scene.cones = {scene::Cone{.base = {1.2, -1, 0.2},
                             .apex = {1.4, 1.1, 0},
                             .base_radius = 0.8,
                             .apex_radius = 0.1,
                             .material = 0,
                             .number = 3}};
  scene.lights = {scene::Light{.position = {0, 3, 6}}};
  scene.camera = scene::Camera{};
  return scene;
}

// The rays go from one eye through the points of a grid, past the scene's edges; none goes along an axis.
std::vector<Ray> known_rays() {
  std::vector<Ray> rays;
  for (int y = 0; y < kDown; ++y)
    for (int x = 0; x < kAcross; ++x)
      rays.push_back({{0.1f, 0.2f, 6},
                      0,
                      {0.12f * static_cast<float>(x) - 0.43f, 0.12f * static_cast<float>(y) - 0.31f, -1},
                      std::numeric_limits<float>::infinity()});
  return rays;
}

std::span<const Answer> known_answers() {
  return kAnswers;
}

namespace {

constexpr const char* kProgram = "traverse/query.cl";
constexpr const char* kVectorsTest = "common/simd_test.cl";

float number(std::uint32_t bits) {
  return std::bit_cast<float>(bits);
}

Answer bits_of(const Hit& hit) {
  return {std::bit_cast<std::uint32_t>(hit.t), hit.primitive, std::bit_cast<std::uint32_t>(hit.u),
          std::bit_cast<std::uint32_t>(hit.v)};
}

bool close(float a, float b) {
  return a == b || std::abs(a - b) <= 1e-5f * std::max(1.0f, std::abs(b));
}

bool agrees(const Hit& hit, const Answer& right, bool exact) {
  if (exact || hit.primitive != right.primitive) return bits_of(hit) == right;
  return close(hit.t, number(right.t)) && close(hit.u, number(right.u)) && close(hit.v, number(right.v));
}

std::string check_occlusion(const std::vector<Hit>& hits) {
  for (std::size_t i = 0; i < hits.size(); ++i)
    if ((hits[i].t == 0) != (known_answers()[i].primitive >= 0))
      return fmt::format("occlusion of ray {} is wrong", i);
  return "";
}

// Verdicts are kept beside built programs, where these are kept.
device::Verdicts verdicts_of(const device::Context& context) {
  const std::shared_ptr<device::ProgramCache>& cache = context.builds().cache;
  return device::Verdicts(cache ? cache->folder() : std::filesystem::path());
}

}  // namespace

std::string first_fault(const std::vector<Hit>& hits, bool exact) {
  const std::span<const Answer> answers = known_answers();
  if (hits.size() != answers.size()) return "hits are missing";
  for (std::size_t i = 0; i < hits.size(); ++i)
    if (!agrees(hits[i], answers[i], exact))
      return fmt::format("ray {} should hit primitive {} at t = {}, but hits {} at {}", i,
                         answers[i].primitive, number(answers[i].t), hits[i].primitive, hits[i].t);
  return "";
}

namespace {

// Traces rays through the known scene, on a device with buffers of its own for it.
class Known {
 public:
  explicit Known(const device::Context& context)
      : context_(context),
        scene_(prepare::prepare(known_scene(), TreeOptions{})),
        buffers_(context, scene_.flat, scene_.wide),
        programs_(context, scene_.tree_depth, scene_.wide) {}

  std::vector<Hit> trace(bool any_hit) {
    constexpr std::size_t kWorkGroup = 16;
    const bool cpu = context_.info().kind == "cpu";
    query::Target target{context_, buffers_, programs_, scene_,
                         std::min(kWorkGroup, context_.max_work_group())};
    // Of the walks by which the device renders, the one that is compiled fastest.
    target.traversal = cpu ? Traversal::batch : Traversal::wide;
    return query::trace(target, known_rays(), {.any_hit = any_hit}).hits;
  }

 private:
  const device::Context& context_;
  const prepare::Prepared scene_;
  const wavefront::SceneBuffers buffers_;
  wavefront::Programs programs_;
};

}  // namespace

std::vector<Answer> answers_of(const device::Context& opened) {
  const device::Context context = opened.without_cache();
  std::vector<Answer> answers;
  for (const Hit& hit : Known(context).trace(false)) answers.push_back(bits_of(hit));
  return answers;
}

std::string fault_of(const device::Context& opened) {
  const device::Context context = opened.without_cache();  // the program is not for keeping
  const bool cpu = context.info().kind == "cpu";
  Known known(context);
  const std::string fault = first_fault(known.trace(false), cpu && context.rounds_division_correctly());
  return fault.empty() ? check_occlusion(known.trace(true)) : fault;
}

Hash verdict_key(const cl::Device& device) {
  const char* const form = std::getenv("KDRAY_SIMD");
  return device::program_key(
      device::identity_of(device), device::expand_source(kProgram),
      fmt::format("self-test {} {}", form ? form : "", in_hex(hash_of(device::expand_source(kVectorsTest)))));
}

device::Verdict passed_with(device::Simd form) {
  return {true, device::build_option(form)};
}

void require(const device::Context& context, bool fail) {
  static std::mutex mutex;
  const std::lock_guard lock(mutex);
  const Hash key = device::checked("asking " + context.info().name,
                                   [&] { return verdict_key(context.opened().devices.front()); });
  const device::Verdicts verdicts = verdicts_of(context);
  const std::optional<device::Verdict> known = verdicts.find(key);
  const device::Verdict passed = passed_with(context.simd());
  if (!fail && known == passed) return;
  const std::string fault = fail ? "told to fail" : fault_of(context);
  if (!fault.empty() && !fail && !known) verdicts.note(key, {false, "fails the self-test: " + fault});
  if (!fault.empty())
    throw Error(ErrorCode::no_device,
                fmt::format("{} fails the self-test: {}; try another device or driver, see `kdray devices`",
                            context.info().name, fault));
  if (!known || known->passed) verdicts.note(key, passed);
}

}  // namespace kdray::selftest
