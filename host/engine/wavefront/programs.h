// What    The programs of a render, each built for the feature bits it reads, kept for the next render.
// Shape   One program per kernel file; programs that the features make needless are not built. A program that
//         is kept from another scene and has more than is wanted may take a program's place
//         (device/opencl/variant.h): its answers are the same, and so is what the host makes for it.
#pragma once

#include <map>
#include <mutex>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "accel/flatten/wide.h"
#include "device/opencl/context.h"
#include "device/opencl/kernel.h"
#include "device/opencl/variant.h"
#include "kdray/options.h"
#include "layout/features.h"

namespace kdray::wavefront {

// What programs depend on of the trees that they walk.
struct TreeForm {
  int depth = 0;          // of the binary tree: sizes that walk's stack
  int widen = 1;          // of the wide form
  int stack = 0;          // what a walk of the wide form stacks at most
  int block = 4;          // of the wide form
  std::size_t bytes = 0;  // of the wide form
};

// What the programs of a render came from.
struct ProgramsUsed {
  std::size_t compiled = 0;    // by this process
  std::size_t found = 0;       // kept from another, of just the features that are wanted
  std::size_t covering = 0;    // kept from another, and of more features
  layout::Features spare = 0;  // features that some of them have and nobody wanted

  void add(const ProgramsUsed& other);
};

// The most entries of a walk of the wide form that visits a node's children in any order: seven are left
// behind on each level, and eight lie on the last.
int any_order_stack_size(int tree_depth);

class Programs {
 public:
  // `more_options`: for all builds.
  Programs(const device::Context& context, const TreeForm& form, std::string more_options = {});
  Programs(const device::Context& context, int tree_depth, const flatten::WideForm& wide,
           std::string more_options = {});

  // Forms of trees such that programs for them serve nearly all scenes there are.
  struct UsualForm {
    TreeForm form;
    std::string scenes;  // in words
  };
  static std::vector<UsualForm> usual_forms();

  // From now on programs have all features that they may have, whatever is wanted of them.
  void have_everything() { everything_ = true; }

  // Whether queries with Traversal::wide have a work-item for each ray, without vectors, as GPUs want it: by
  // themselves all devices but CPUs.
  void query_alone(bool alone) { queries_alone_ = alone; }
  // Whether the file's program walks compressed nodes, with one ray to a work-item: as stages that are not
  // fused do.
  bool walks_alone(const std::string& file, Traversal traversal) const;

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

  // Launches of a frame's kernels, of `items` work-items in groups of `local`.
  struct Launches {
    layout::Features features;
    Traversal traversal;
    Precision precision;
    bool fused;
    std::size_t items, local;

    auto operator<=>(const Launches&) const = default;
  };
  // Return whether there were no such launches yet, since PoCL compiles a kernel for good with the first
  // ones, and take down that there were.
  bool are_new(const Launches& launches) const;
  void were_launched(const Launches& launches);

  double build_seconds() const { return build_seconds_; }
  const ProgramsUsed& used() const { return used_; }
  std::size_t n_built() const {
    const std::lock_guard lock(mutex_);
    return programs_.size();
  }
  static std::size_t n_known();  // files that a program can be built of

 private:
  // The last: walk_options_.
  using Key = std::tuple<std::string, layout::Features, Traversal, Precision, std::string>;

  Key key_of(const Wanted& wanted) const;
  const cl::Program& program(const Wanted& wanted);
  device::Variant variant_for(const Key& key) const;
  std::string options_for(const std::string& file, Traversal traversal, Precision precision, int stack) const;

  const device::Context* context_;
  std::string more_options_, walk_options_;
  int stack_size_, wide_stack_size_, any_order_stack_size_, block_, widen_;
  Array<layout::WideNode> nodes_;
  int levels_ = 0;  // of the nodes, rounded up; found when a program asks for them
  bool prefetch_, far_, queries_alone_, everything_ = false;
  double build_seconds_ = 0;
  mutable std::mutex mutex_;  // of what is built: queries of several threads ask for kernels
  ProgramsUsed used_;
  std::map<Key, cl::Program> programs_;
  std::set<std::tuple<std::string, bool, Launches>> launched_;  // with walk_options_ and everything_
};

}  // namespace kdray::wavefront
