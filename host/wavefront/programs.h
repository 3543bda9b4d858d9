// What    The programs of a render, each built for the feature bits it reads, kept for the next render.
// Shape   One program per kernel file; programs that the features make needless are not built.
#pragma once

#include <map>
#include <string>
#include <tuple>

#include "device/context.h"
#include "flatten/wide.h"
#include "kdray/kdray.h"

namespace kdray::wavefront {

class Programs {
 public:
  // `tree_depth` sizes the binary walk's stack, the wide form its own walks' and their blocks.
  Programs(const device::Context& context, int tree_depth, const flatten::WideForm& wide);

  // The kernel `name` of `file` ("traverse/trace_closest.cl"), built for the bits of `features` that the file reads.
  // A new kernel object each time: arguments are the caller's own.
  // `traversal` (never Traversal::automatic where a file is built for one walk) is for the files that walk the tree.
  cl::Kernel kernel(const std::string& file, const std::string& name, std::uint32_t features,
                    Traversal traversal = Traversal::binary);

  double build_seconds() const { return build_seconds_; }
  std::size_t n_built() const { return programs_.size(); }

 private:
  std::string options_for(std::uint32_t features, Traversal traversal) const;

  const device::Context* context_;
  int stack_size_, wide_stack_size_, block_;
  bool prefetch_;
  double build_seconds_ = 0;
  std::map<std::tuple<std::string, std::uint32_t, Traversal>, cl::Program> programs_;
};

}  // namespace kdray::wavefront
