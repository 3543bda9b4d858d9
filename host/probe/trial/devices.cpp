#include "probe/trial/devices.h"

#include <fmt/format.h>

#include <optional>
#include <set>

#include "device/opencl/opencl_error.h"
#include "probe/selftest/self_test.h"

namespace kdray::trial {

namespace {

Hash key_of(const device::FoundDevice& found) {
  return device::checked("asking " + found.info.name, [&] { return selftest::verdict_key(found.device); });
}

std::pair<std::uint64_t, std::uint64_t> place(const Hash& key) {
  return {key.high, key.low};
}

std::unique_ptr<Trial> trial_of(const device::FoundDevice& found, const Hash& key) {
  return std::make_unique<Trial>(Subject::device, key, std::map<std::string, std::string>(),
                                 found.info.kind == "gpu" ? kGpuTrialSeconds : kTrialSeconds);
}

void note(const device::Verdicts& verdicts, const Hash& key, const Outcome& outcome) {
  if (!outcome.verdict) return;
  if (outcome.lasting) verdicts.note(key, *outcome.verdict);
  device::Mark::forget(verdicts, key);
}

}  // namespace

// What is known of a kind of device, or how it is being found out.
struct DeviceTrials::Case {
  Hash key;
  std::optional<device::Verdict> verdict = {};
  std::unique_ptr<Trial> trial = {};
  std::unique_ptr<device::Mark> mark = {};  // it is tested in this process
};

DeviceTrials::DeviceTrials(device::Verdicts verdicts, bool all, std::function<void(bool)> watch)
    : verdicts_(std::move(verdicts)), all_(all), watch_(std::move(watch)) {}

DeviceTrials::~DeviceTrials() = default;

std::string DeviceTrials::why_not(const std::vector<device::FoundDevice>& candidates, std::size_t i) {
  Case& c = case_of(candidates[i]);
  if (!c.verdict && !c.mark && !c.trial) begin(candidates, i);
  if (c.trial) settle(c);
  return !c.verdict || c.verdict->passed ? "" : in_words(candidates[i].info, *c.verdict);
}

DeviceTrials::Case& DeviceTrials::case_of(const device::FoundDevice& found) {
  const Hash key = key_of(found);
  std::unique_ptr<Case>& c = cases_[place(key)];
  if (!c) c.reset(new Case{key, verdicts_.find(key)});
  return *c;
}

void DeviceTrials::begin(const std::vector<device::FoundDevice>& candidates, std::size_t first) {
  Case& wanted = case_of(candidates[first]);
  if (is_the_only_one() && !device::Mark::is_left(verdicts_, wanted.key)) {
    wanted.mark = std::make_unique<device::Mark>(verdicts_, wanted.key);
    return;
  }
  for (std::size_t i = first; i < candidates.size(); ++i) {
    Case& c = case_of(candidates[i]);
    if (c.verdict && c.verdict->passed && !all_) break;
    if (!c.verdict && !c.trial) c.trial = trial_of(candidates[i], c.key);
  }
}

void DeviceTrials::settle(Case& c) {
  if (watch_) watch_(true);
  const Outcome& outcome = c.trial->outcome();
  if (watch_) watch_(false);
  note(verdicts_, c.key, outcome);
  c.verdict = outcome.verdict;
  c.trial.reset();
  if (!c.verdict) settle_without_trial(c);
}

// No program could try the device: this process does, unless that has been too much for another one.
void DeviceTrials::settle_without_trial(Case& c) {
  if (device::Mark::is_left(verdicts_, c.key) && !is_the_only_one())
    c.verdict = device::Verdict{false, "has ended or held up a program that tested it"};
  else
    c.mark = std::make_unique<device::Mark>(verdicts_, c.key);
}

bool DeviceTrials::is_the_only_one() {
  if (n_kinds_ < 0) {
    std::set<Key> kinds;
    for (const device::FoundDevice& found : device::find_devices())
      if (found.info.usable) kinds.insert(place(key_of(found)));
    n_kinds_ = static_cast<int>(kinds.size());
  }
  return n_kinds_ == 1;
}

Outcome try_anew(const device::FoundDevice& found, const device::Verdicts& verdicts) {
  const Hash key = key_of(found);
  const auto trial = trial_of(found, key);
  note(verdicts, key, trial->outcome());
  return trial->outcome();
}

std::string in_words(const DeviceInfo& info, const device::Verdict& verdict) {
  return fmt::format("{} {}; `--device {}` insists on it, `kdray doctor` tries it again", info.name,
                     verdict.text, info.number);
}

}  // namespace kdray::trial
