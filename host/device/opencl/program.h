// What    Builds programs for a context from kernel files of kernels/: expands a file's includes from the
//         embedded sources (or from the folder that KDRAY_KERNEL_DIR names), so that the program text is
//         whole and a key for the program cache.
// Errors  A failed build throws with the compiler's first error line and the name of a file that holds the
//         expanded source and the whole log.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "device/opencl/opencl.h"
#include "device/opencl/program_cache.h"

namespace kdray::device {

// Where built programs are kept, and who is told when a compiler is at work.
struct Builds {
  std::shared_ptr<ProgramCache> cache = {};  // none: programs are built anew
  // Called with true when a compiler begins its work and with false when it ends, from any thread; calls may
  // nest.
  std::function<void(bool)> watch = {};
  // Programs stay in memory until the process ends: building the same again returns the same.
  bool remember = false;
  // Builds programs of just the bits that are wanted, though the cache may have others that cover them
  // (variant.h).
  bool exact = false;
};

// Reports a compiler's work to `watch` as long as it lives.
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

// Returns the text of `file` with every "#include "..."" replaced, each included file once, and #line marks.
std::string expand_source(const std::string& file);

// Does the same for a text that is no file; `name` is used in messages.
std::string expand_text(const std::string& name, const std::string& text);

// Builds an expanded source, or finds it in the cache. Where the compiler refuses it, returns an empty
// program and writes to `log` what the compiler said.
cl::Program try_build(const cl::Context& context, const std::vector<cl::Device>& devices,
                      const std::string& source, const std::string& options, const Builds& builds,
                      std::string& log);

// Does the same, but throws where the compiler refuses it.
cl::Program build_source(const cl::Context& context, const std::vector<cl::Device>& devices,
                         const std::string& name, const std::string& source, const std::string& options,
                         const Builds& builds = {});

// Compiles it whatever the cache holds, and notes it there under the key; throws where the compiler refuses
// it.
cl::Program compile_source(const cl::Context& context, const std::vector<cl::Device>& devices,
                           const std::string& name, const std::string& source, const std::string& options,
                           const ProgramKey& key, const Builds& builds);

cl::Program build_program(const cl::Context& context, const std::vector<cl::Device>& devices,
                          const std::string& file, const std::string& options, const Builds& builds = {});

}  // namespace kdray::device
