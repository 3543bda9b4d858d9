// What    Builds a kernel file of kernels/ for a context: expands its includes from the embedded sources (or from
//         the folder KDRAY_KERNEL_DIR names), so that the program text is whole and a key for caches.
// Errors  A failed build throws with the compiler's first error line and the name of a file that holds the expanded
//         source and the whole log.
#pragma once

#include <string>
#include <vector>

#include "device/opencl.h"

namespace kdray::device {

// The text of `file` with every "#include "..."" replaced, each included file once, and #line marks.
std::string expand_source(const std::string& file);

// The same for a text that is no file; `name` is used in messages.
std::string expand_text(const std::string& name, const std::string& text);

// Builds an expanded source.
cl::Program build_source(const cl::Context& context, const std::vector<cl::Device>& devices,
                         const std::string& name, const std::string& source, const std::string& options);

cl::Program build_program(const cl::Context& context, const std::vector<cl::Device>& devices,
                          const std::string& file, const std::string& options);

}  // namespace kdray::device
