// What    What goes with the building of programs: where they are kept, and who is told when a compiler is at
//         work.
#pragma once

#include <functional>
#include <memory>
#include <utility>

namespace kdray::device {

class ProgramCache;

struct Builds {
  std::shared_ptr<ProgramCache> cache = {};  // none: programs are built anew
  // Is told true when a compiler begins its work and false when it ends. Calls come from any thread and may
  // nest.
  std::function<void(bool)> watch = {};
  // Programs stay in memory until the process ends: who builds the same again is given the same.
  bool remember = false;
  // Programs of just the bits that are wanted, though others may be there that cover them (variant.h).
  bool exact = false;
};

// Tells `watch` of a compiler's work as long as it lives.
class AtWork {
 public:
  explicit AtWork(const Builds& builds) : watch_(builds.watch) {
    if (watch_) watch_(true);
  }
  ~AtWork() {
    if (watch_) watch_(false);
  }
  AtWork(const AtWork&) = delete;
  AtWork& operator=(const AtWork&) = delete;

 private:
  std::function<void(bool)> watch_;
};

}  // namespace kdray::device
