// What    Builds a kernel file of kernels/ for a context: expands its includes from the embedded sources (or
//         from the folder KDRAY_KERNEL_DIR names), so that the program text is whole and a key for the
//         program cache.
// Errors  A failed build throws with the compiler's first error line and the name of a file that holds the
//         expanded source and the whole log.
#pragma once

#include <string>
#include <vector>

#include "device/opencl/builds.h"
#include "device/opencl/opencl.h"
#include "device/opencl/program_key.h"

namespace kdray::device {

// The text of `file` with every "#include "..."" replaced, each included file once, and #line marks.
std::string expand_source(const std::string& file);

// The same for a text that is no file; `name` is used in messages.
std::string expand_text(const std::string& name, const std::string& text);

// Builds an expanded source, or finds it in the cache. `log`: what the compiler said, where the program comes
// out empty.
cl::Program try_build(const cl::Context& context, const std::vector<cl::Device>& devices,
                      const std::string& source, const std::string& options, const Builds& builds,
                      std::string& log);

// The same; throws where the compiler refuses it.
cl::Program build_source(const cl::Context& context, const std::vector<cl::Device>& devices,
                         const std::string& name, const std::string& source, const std::string& options,
                         const Builds& builds = {});

// Compiles it whatever the cache holds, for which it is noted under the key; throws where it is refused.
cl::Program compile_source(const cl::Context& context, const std::vector<cl::Device>& devices,
                           const std::string& name, const std::string& source, const std::string& options,
                           const ProgramKey& key, const Builds& builds);

cl::Program build_program(const cl::Context& context, const std::vector<cl::Device>& devices,
                          const std::string& file, const std::string& options, const Builds& builds = {});

}  // namespace kdray::device
