// What    The parts that a queue's device holds: all of its own, or as many as fit, those least recently served going first.
#pragma once

#include <cstdint>
#include <list>
#include <memory>

#include "odprt/division.h"
#include "odprt/worker.h"

namespace kdray::odprt {

class PartStore {
 public:
  // `most_bytes` of geometry; 0: no limit, and parts are used where they lie if the device works in the host's memory.
  PartStore(const device::Context& context, const Division& division, const Cut& cut, std::size_t most_bytes)
      : context_(context), division_(division), cut_(cut), most_bytes_(most_bytes) {}

  // Loads the part if it isn't there. What it returns stays until another part is asked for.
  const LoadedPart& get(std::uint32_t part);

  std::size_t peak_bytes() const { return peak_bytes_; }
  std::uint64_t n_loads() const { return n_loads_; }

 private:
  std::unique_ptr<LoadedPart> load(std::uint32_t part);
  void make_room(std::size_t bytes);

  const device::Context& context_;
  const Division& division_;
  const Cut& cut_;
  const std::size_t most_bytes_;
  std::list<std::unique_ptr<LoadedPart>> loaded_;  // the last served first
  std::size_t bytes_ = 0, peak_bytes_ = 0;
  std::uint64_t n_loads_ = 0;
};

}  // namespace kdray::odprt
