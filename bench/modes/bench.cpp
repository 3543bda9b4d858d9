#include "bench/modes/bench.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>

#include "accel/prepare/prepared.h"
#include "bench/workload/scenes.h"

namespace kdray::bench {

namespace {

const Scheme kSequential{"sequential"};
const Scheme kWholeDevice{"one queue, all cores", Mode::pdprt, Division::bag, Balance::pilot, true};

// A row being measured.
class Runner {
 public:
  Runner(const PreparedScene& scene, const Scheme& scheme, int queues, int cores, const DeviceOptions& device)
      : scene_(scene), scheme_(scheme), device_(device) {
    row_.scheme = scheme.name;
    row_.queues = queues;
    row_.sub_devices = std::min(queues, cores);
  }

  // A frame; the first one's picture becomes `first`.
  void run_round(RenderOptions options, bool counts, std::optional<Picture>& first) {
    if (!row_.failure.empty()) return;
    options.mode = scheme_.mode, options.division = scheme_.division, options.balance = scheme_.balance;
    try {
      if (!renderer_) renderer_ = std::make_unique<Renderer>(scene_, device_);
      Picture picture = renderer_->render(options);
      if (first) row_.differing_pixels += differing_pixels(*first, picture);
      if (!first) first = std::move(picture);
      if (counts) record(renderer_->statistics());
    } catch (const Error& error) {
      fail(error.what());
    }
  }

  // A frame that doesn't count, since keeping its timeline takes time.
  void keep_timeline(RenderOptions options) {
    options.timeline = true;
    std::optional<Picture> none;
    run_round(options, false, none);
    if (renderer_) row_.timeline = renderer_->timeline();
  }

  int queues() const { return row_.queues; }

  ModesRow row() const {
    ModesRow row = row_;
    row.seconds = spread_of(row.rounds);
    if (!idle_.empty()) row.idle_share = spread_of(idle_);
    if (!busy_.empty()) row.busy_seconds = spread_of(busy_).median;
    return row;
  }

 private:
  void fail(const std::string& why) {
    row_ = {row_.scheme, row_.queues, row_.sub_devices, why};
    idle_.clear(), busy_.clear();
    renderer_.reset();
  }

  void record(const Statistics& s) {
    const Statistics::Division& division = s.mode.division.value();
    row_.rounds.push_back(s.seconds.render);
    row_.sub_devices = std::min(row_.queues, static_cast<int>(division.sub_devices));
    double idle = 0, busy = 0;
    for (const Statistics::Queue& q : division.per_queue) idle += q.idle_share, busy += q.busy_seconds;
    if (const std::size_t n = division.per_queue.size(); n > 0)
      idle_.push_back(idle / static_cast<double>(n)), busy_.push_back(busy);
    auto whole = static_cast<double>(s.memory.scene_bytes);
    if (division.odprt) {
      row_.rays_exchanged = static_cast<double>(division.odprt->rays_total);
      row_.bytes_exchanged = static_cast<double>(division.odprt->bytes_total);
      whole = static_cast<double>(division.odprt->whole_geometry_bytes);  // without the binary tree
    }
    double geometry = 0, work = 0;
    for (const Statistics::QueueMemory& q : s.memory.per_queue) {
      geometry = std::max(geometry, static_cast<double>(q.geometry_bytes));
      work = std::max(work, static_cast<double>(q.work_bytes));
    }
    if (s.memory.per_queue.empty()) return;
    row_.geometry_bytes = geometry, row_.work_bytes = work;
    if (whole > 0) row_.geometry_share = geometry / whole;
  }

  const PreparedScene& scene_;
  const Scheme& scheme_;
  DeviceOptions device_;
  std::unique_ptr<Renderer> renderer_;
  ModesRow row_;
  std::vector<double> idle_, busy_;
};

class ModesScene {
 public:
  ModesScene(const ModesOptions& options, const std::string& name)
      : options_(options), scene_(load_scene(name)), prepared_(scene_, {.binary_form = false}) {
    Renderer renderer(prepared_, {.device = options.device});
    run_.scene = name;
    run_.n_primitives = scene_.primitives();
    run_.machine = machine_of(renderer.statistics());
    run_.scene_bytes = renderer.statistics().memory.scene_bytes;
    divisible_ = renderer.statistics().device.kind == "cpu";
  }

  ModesRun run() {
    add(kSequential, 1);
    add(kWholeDevice, 1);
    for (const int queues : options_.queues)
      for (const Scheme& scheme : schemes()) add(scheme, queues);
    std::optional<Picture> first;
    for (int round = -1; round < options_.repeat; ++round)
      for (Runner& runner : runners_) runner.run_round(frame(), round >= 0, first);
    for (Runner& runner : runners_)
      if (runner.queues() > 1 && runner.queues() == most_queues_with_cores()) runner.keep_timeline(frame());
    for (const Runner& runner : runners_) run_.rows.push_back(runner.row());
    runners_.clear();
    if (options_.model) predict();
    return std::move(run_);
  }

 private:
  // A device with as many cores as queues, where it has them.
  DeviceOptions device(int queues, bool whole) const {
    const int cores = !whole && divisible_ && queues < run_.machine.cores ? queues : 0;
    return {.device = options_.device, .queues = queues, .compute_units = cores};
  }

  RenderOptions frame() const {
    return {.width = options_.width, .height = options_.height, .depth = options_.depth};
  }

  int most_queues_with_cores() const {
    int most = 0;
    for (const int queues : options_.queues)
      if (queues <= run_.machine.cores) most = std::max(most, queues);
    return most;
  }

  void add(const Scheme& scheme, int queues) {
    runners_.emplace_back(prepared_, scheme, queues, divisible_ ? run_.machine.cores : queues,
                          device(queues, scheme.whole_device));
  }

  void predict() {
    const ModesRow& alone = run_.rows.front();
    if (!alone.failure.empty()) {
      run_.model_failure = "one core alone has no time to begin with";
      return;
    }
    std::vector<int> queues = options_.queues;
    queues.insert(queues.end(), kModelQueues.begin(), kModelQueues.end());
    std::sort(queues.begin(), queues.end());
    queues.erase(std::unique(queues.begin(), queues.end()), queues.end());
    ModelInput input{scene_.model(), prepared_.prepared(), alone.seconds.median, overhead(), queues};
    try {
      Renderer renderer(prepared_, device(1, false));
      run_.model = predict_modes(input, renderer, frame(), options_.model_options);
    } catch (const Error& error) {
      run_.model_failure = error.what();
    }
  }

  // How many times as long ODPRT takes as PDPRT when there is no one to exchange rays with.
  std::optional<double> overhead() const {
    const ModesRow *odprt = run_.find("odprt pilot", 1), *pdprt = run_.find("pdprt bag", 1);
    if (odprt == nullptr || pdprt == nullptr) return std::nullopt;
    return odprt->seconds.median / pdprt->seconds.median;
  }

  const ModesOptions& options_;
  Scene scene_;
  PreparedScene prepared_;
  ModesRun run_;
  bool divisible_ = false;
  std::vector<Runner> runners_;
};

}  // namespace

const std::vector<Scheme>& schemes() {
  static const std::vector<Scheme> kSchemes = {
      {"pdprt contiguous", Mode::pdprt, Division::contiguous, Balance::pilot},
      {"pdprt interleaved", Mode::pdprt, Division::interleaved, Balance::pilot},
      {"pdprt bag", Mode::pdprt, Division::bag, Balance::pilot},
      {"odprt sah", Mode::odprt, Division::bag, Balance::sah},
      {"odprt pilot", Mode::odprt, Division::bag, Balance::pilot},
      {"odprt dynamic", Mode::odprt, Division::bag, Balance::dynamic}};
  return kSchemes;
}

const ModesRow* ModesRun::find(const std::string& scheme, int queues) const {
  for (const ModesRow& row : rows)
    if (row.scheme == scheme && row.queues == queues && row.failure.empty() && !row.rounds.empty())
      return &row;
  return nullptr;
}

std::optional<double> ModesRun::speed_up(const ModesRow& row) const {
  if (!row.failure.empty() || rows.empty() || !rows.front().failure.empty()) return std::nullopt;
  if (!(row.seconds.median > 0)) return std::nullopt;
  return rows.front().seconds.median / row.seconds.median;
}

std::vector<ModesRun> bench_modes(const ModesOptions& options, const Progress<ModesRun>& progress) {
  return run_scenes<ModesScene>(options, progress);
}

std::size_t count_differing_pixels(std::span<const ModesRun> runs) {
  return count_over(runs, [](const ModesRun& run) {
    return count_over(run.rows, [](const ModesRow& row) { return row.differing_pixels; });
  });
}

std::size_t differing_pixels(const Picture& a, const Picture& b) {
  if (a.rgb.size() != b.rgb.size()) return std::max(a.rgb.size(), b.rgb.size()) / 3;
  std::size_t n = 0;
  for (std::size_t i = 0; i + 2 < a.rgb.size(); i += 3)
    n += std::memcmp(&a.rgb[i], &b.rgb[i], 3 * sizeof(float)) != 0 ? 1 : 0;
  return n;
}

std::optional<double> odprt_over_pdprt(std::span<const ModesRun> runs, const std::string& balance,
                                       int queues) {
  double sum_of_logs = 0;
  int n = 0;
  for (const ModesRun& run : runs) {
    const ModesRow *odprt = run.find(balance, queues), *pdprt = run.find("pdprt bag", queues);
    if (odprt == nullptr || pdprt == nullptr) continue;
    sum_of_logs += std::log(odprt->seconds.median / pdprt->seconds.median);
    ++n;
  }
  if (n == 0) return std::nullopt;
  return std::exp(sum_of_logs / n);
}

}  // namespace kdray::bench
