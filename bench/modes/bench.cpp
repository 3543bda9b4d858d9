#include "bench/modes/bench.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <nlohmann/json.hpp>

#include "accel/prepare/prepared.h"
#include "api/statistics_json.h"
#include "bench/measure/cores.h"
#include "bench/workload/scenes.h"

namespace kdray::bench {

namespace {

const Scheme kSequential{"sequential"};
const Scheme kWholeDevice{"one queue, all cores", Mode::pdprt, Division::bag, Balance::pilot, true};

// The number at a path of keys, where there is one.
std::optional<double> number_at(const nlohmann::json& json, const std::string& path) {
  const nlohmann::json::json_pointer pointer(path);
  if (!json.contains(pointer) || !json.at(pointer).is_number()) return std::nullopt;
  return json.at(pointer).get<double>();
}

// The numbers that the entries of a list have under a key.
std::vector<double> numbers_of(const nlohmann::json& json, const std::string& path, const std::string& key) {
  std::vector<double> found;
  const nlohmann::json::json_pointer pointer(path);
  if (!json.contains(pointer)) return found;
  for (const nlohmann::json& entry : json.at(pointer))
    if (const auto number = number_at(entry, "/" + key)) found.push_back(*number);
  return found;
}

std::optional<double> largest(const std::vector<double>& values) {
  if (values.empty()) return std::nullopt;
  return *std::max_element(values.begin(), values.end());
}

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
      if (counts) record(api::statistics_json(renderer_->statistics()));
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

  void record(const nlohmann::json& statistics) {
    row_.rounds.push_back(statistics.at("seconds").at("render"));
    if (const auto n = number_at(statistics, "/mode/sub_devices"))
      row_.sub_devices = std::min(row_.queues, static_cast<int>(*n));
    const auto idle = numbers_of(statistics, "/mode/per_queue", "idle_share");
    if (!idle.empty()) idle_.push_back(sum(idle) / static_cast<double>(idle.size()));
    const auto busy = numbers_of(statistics, "/mode/per_queue", "busy_seconds");
    if (!busy.empty()) busy_.push_back(sum(busy));
    row_.rays_exchanged = number_at(statistics, "/mode/exchange/rays_total");
    row_.bytes_exchanged = number_at(statistics, "/mode/exchange/bytes_total");
    row_.geometry_bytes = largest(numbers_of(statistics, "/memory/per_queue", "geometry_bytes"));
    row_.work_bytes = largest(numbers_of(statistics, "/memory/per_queue", "work_bytes"));
    auto whole = number_at(statistics, "/mode/whole_geometry_bytes");  // ODPRT has no use for the binary tree
    if (!whole) whole = number_at(statistics, "/memory/scene_bytes");
    if (row_.geometry_bytes && whole.value_or(0) > 0) row_.geometry_share = *row_.geometry_bytes / *whole;
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
    const nlohmann::json facts = api::statistics_json(renderer.statistics());
    run_.scene = name;
    run_.device = facts.at("device").at("name");
    run_.n_primitives = scene_.primitives();
    run_.scene_bytes = number_at(facts, "/memory/scene_bytes").value_or(0);
    run_.cores = cores_of(facts.at("device"));
    divisible_ = facts.at("device").at("kind") == "cpu";
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
    const int cores = !whole && divisible_ && queues < run_.cores ? queues : 0;
    return {.device = options_.device, .queues = queues, .compute_units = cores};
  }

  RenderOptions frame() const {
    RenderOptions o;
    o.width = options_.width, o.height = options_.height, o.depth = options_.depth;
    return o;
  }

  int most_queues_with_cores() const {
    int most = 0;
    for (const int queues : options_.queues)
      if (queues <= run_.cores) most = std::max(most, queues);
    return most;
  }

  void add(const Scheme& scheme, int queues) {
    runners_.emplace_back(prepared_, scheme, queues, divisible_ ? run_.cores : queues,
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

std::vector<ModesRun> bench_modes(const ModesOptions& options,
                                  const std::function<void(const ModesRun&)>& done,
                                  const std::function<void(const std::string&)>& working) {
  std::vector<ModesRun> runs;
  for (const std::string& name : options.scenes) {
    working(name);
    runs.push_back(ModesScene(options, name).run());
    done(runs.back());
  }
  return runs;
}

std::size_t count_differing_pixels(std::span<const ModesRun> runs) {
  std::size_t n = 0;
  for (const ModesRun& run : runs)
    for (const ModesRow& row : run.rows) n += row.differing_pixels;
  return n;
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
