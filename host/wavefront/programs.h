// What    The programs of a render, each built for the feature bits it reads, kept for the next render.
// Shape   One program per kernel file; programs that the features make needless are not built.
#pragma once

#include <map>
#include <string>
#include <utility>

#include "device/context.h"

namespace kdray::wavefront {

class Programs {
 public:
  // `tree_depth` sizes the traversal's stack.
  Programs(const device::Context& context, int tree_depth);

  // The kernel `name` of `file` ("traverse/trace_closest.cl"), built for the bits of `features` that the file reads.
  // A new kernel object each time: arguments are the caller's own.
  cl::Kernel kernel(const std::string& file, const std::string& name, std::uint32_t features);

  double build_seconds() const { return build_seconds_; }
  std::size_t n_built() const { return programs_.size(); }

 private:
  std::string options_for(std::uint32_t features) const;

  const device::Context* context_;
  int stack_size_;
  double build_seconds_ = 0;
  std::map<std::pair<std::string, std::uint32_t>, cl::Program> programs_;
};

}  // namespace kdray::wavefront
