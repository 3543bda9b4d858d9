// What    The programs of a render, each built for the feature bits it reads, kept for the next render.
// Shape   One program per kernel file; programs that the features make needless are not built.
#pragma once

#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "device/context.h"
#include "device/kernel.h"
#include "flatten/wide.h"
#include "kdray/options.h"
#include "layout/features.h"

namespace kdray::wavefront {

// The most entries of a walk of the wide form that visits a node's children in any order: seven are left
// behind on each level, and eight lie on the last.
int any_order_stack_size(int tree_depth);

class Programs {
 public:
  // `tree_depth` sizes the binary walk's stack, the wide form its own walks' and their blocks.
  // `more_options`: for all builds.
  Programs(const device::Context& context, int tree_depth, const flatten::WideForm& wide,
           std::string more_options = {});

  // The constants of the walks from now on; what was built with others is kept.
  void use(const Tuning& tuning);

  // The kernel that K describes (kernels::TraceClosest), built for the bits of `features` that its file
  // reads. A new kernel object each time: arguments are the caller's own.
  // `traversal` (never Traversal::automatic where a file is built for one walk) is for the files that walk
  // the tree.
  template <class K>
  device::Kernel<K> kernel(layout::Features features, Traversal traversal = Traversal::binary,
                           Precision precision = Precision::float32) {
    return device::Kernel<K>(program({K::kFile, features, traversal, precision}));
  }

  struct Wanted {
    std::string file;
    layout::Features features;
    Traversal traversal = Traversal::binary;
    Precision precision = Precision::float32;
  };
  // Builds side by side what kernel() will be asked for, where it was not built before.
  void build(const std::vector<Wanted>& wanted);

  double build_seconds() const { return build_seconds_; }
  std::size_t n_built() const { return programs_.size(); }
  static std::size_t n_known();  // files that a program can be built of

 private:
  // The last: walk_options_.
  using Key = std::tuple<std::string, layout::Features, Traversal, Precision, std::string>;

  Key key_of(const Wanted& wanted) const;
  const cl::Program& program(const Wanted& wanted);
  std::string options_for(const std::string& file, layout::Features features, Traversal traversal,
                          Precision precision) const;

  const device::Context* context_;
  std::string more_options_, walk_options_;
  int stack_size_, wide_stack_size_, any_order_stack_size_, block_;
  bool prefetch_, far_;
  double build_seconds_ = 0;
  std::map<Key, cl::Program> programs_;
};

}  // namespace kdray::wavefront
