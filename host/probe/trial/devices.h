// What    Whether a device may be opened in this process: not if it hangs, crashes or fails the self-test,
//         nor while nothing is known of it and there are others.
// Shape   A device of which nothing is known takes the self-test in a child process, at the same time as
//         the other unknown ones that may be used. The only device of a machine is opened under a mark
//         (device/opencl/verdicts.h), and tested in this process: to try it beforehand would compile
//         everything twice for nothing, since there is no other to take. Where a mark was left behind it is
//         tried in a child, too. A device that no program can try is tested in this process, unless there are
//         others and a mark says that it has been too much for a process before.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "device/opencl/platform.h"
#include "device/opencl/verdicts.h"
#include "probe/trial/trial.h"

namespace kdray::trial {

class DeviceTrials {
 public:
  // `all`: every candidate is tried if need be, not only those before the first that is known to be good.
  // `watch` is called with true when children begin and with false when they have ended.
  explicit DeviceTrials(device::Verdicts verdicts, bool all = false, std::function<void(bool)> watch = {});
  ~DeviceTrials();  // kills the children that are still at work
  DeviceTrials(const DeviceTrials&) = delete;
  DeviceTrials& operator=(const DeviceTrials&) = delete;

  // Returns why candidate i, of those sorted with the best first, must not be used; empty: it may be opened.
  std::string why_not(const std::vector<device::FoundDevice>& candidates, std::size_t i);

 private:
  using Key = std::pair<std::uint64_t, std::uint64_t>;
  struct Case;

  Case& case_of(const device::FoundDevice& found);
  void begin(const std::vector<device::FoundDevice>& candidates, std::size_t first);
  void settle(Case& c);
  void settle_without_trial(Case& c);
  bool is_the_only_one();

  const device::Verdicts verdicts_;
  const bool all_;
  const std::function<void(bool)> watch_;
  std::map<Key, std::unique_ptr<Case>> cases_;  // two devices of one kind are one
  int n_kinds_ = -1;                            // of usable devices; -1: not counted yet
};

// Tries the device in a child, whatever is known of it, and notes the verdict.
Outcome try_anew(const device::FoundDevice& found, const device::Verdicts& verdicts);

// Returns what is wrong, after the device's name, and what can be done about it.
std::string in_words(const DeviceInfo& info, const device::Verdict& verdict);

}  // namespace kdray::trial
