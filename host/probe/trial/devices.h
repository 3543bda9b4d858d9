// What    Whether a device may be opened in this process: not one that hangs or crashes, fails the self-test,
//         or that nobody knows yet while there are others.
// Shape   A device of which nothing is known takes the self-test in a child process, beside all others of
//         that kind that may be wanted. The only device there is is taken as it comes, under a mark
//         (device/verdicts.h), and tested in this process: what it costs to know it beforehand would be a
//         second compiler's work for nothing, since there is no other to take. Where a mark was left behind
//         it goes to a child, too; likewise every device where no program can try it, when a mark says that
//         it has been too much for a process.
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
  // `all`: every device of those asked about is tried if need be, not only those that come before the first
  // that is known to be good. `watch` is told true when children begin and false when they have ended.
  explicit DeviceTrials(device::Verdicts verdicts, bool all = false, std::function<void(bool)> watch = {});
  ~DeviceTrials();  // what is still at work is of no interest, and is killed
  DeviceTrials(const DeviceTrials&) = delete;
  DeviceTrials& operator=(const DeviceTrials&) = delete;

  // Why this one of the candidates, the best first, is not to be used; empty: it may be opened.
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

// Tries the device in a child and notes the verdict, whatever is known of it.
Outcome try_anew(const device::FoundDevice& found, const device::Verdicts& verdicts);

// What is wrong, after the device's name, and what can be done about it.
std::string in_words(const DeviceInfo& info, const device::Verdict& verdict);

}  // namespace kdray::trial
