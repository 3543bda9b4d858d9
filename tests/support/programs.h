// What    Programs that tests keep in the folder KDRAY_TEST_PROGRAMS, where that is set: some runtimes
//         compile for seconds what a test launches for milliseconds, and again for every context that it
//         opens (scripts/portability).
#pragma once

#include <cstdlib>
#include <filesystem>
#include <memory>

#include "device/opencl/program.h"
#include "device/opencl/program_cache.h"

namespace kdray::test {

// Where the variable is empty, nothing is kept.
inline std::filesystem::path programs_folder() {
  const char* const folder = std::getenv("KDRAY_TEST_PROGRAMS");
  return folder != nullptr ? folder : "";
}

// The cache that a new context is given. What those before it had to build is written down now.
inline device::Builds kept_programs() {
  static const auto cache = programs_folder().empty()
                                ? std::shared_ptr<device::ProgramCache>()
                                : std::make_shared<device::ProgramCache>(programs_folder());
  if (cache) cache->keep();
  return {cache, {}};
}

}  // namespace kdray::test
