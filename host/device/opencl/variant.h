// What    A program whose place others can take: programs of the same source that differ in the feature mask
//         (KDRAY_FEATURES), or in sizes, and give the same answers bit for bit.
// Shape   A mask covers the wanted one when it has all its bits, and no others but spare ones.
//         build_variant() takes the program that was asked for where the cache has it, else one there that
//         covers it, else compiles. What is compiled is for just what is wanted, until a few programs of its
//         family are in the cache that don't serve: then it is for everything, and nothing of the family is
//         compiled again.
// Why     Compilers take seconds, and what a scene doesn't need costs a program that has it a few percent
//         (docs/design/start.md).
// Errors  As building (program.h): ErrorCode::no_device where the compiler refuses the program.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "device/opencl/opencl.h"
#include "device/opencl/program.h"

namespace kdray::device {

struct Variant {
  std::string options;                    // all but the mask
  std::vector<std::string> instead = {};  // options that serve as well, from the best on
  std::uint64_t mask = 0;                 // what is wanted
  std::uint64_t spare = 0;                // what a program may have beside it
};

// Returns the whole options of a program with this mask.
std::string options_with(const std::string& options, std::uint64_t mask);

bool covers(std::uint64_t mask, const Variant& wanted);

// Returns those of `masks` that cover what is wanted, the one with the fewest other bits first.
std::vector<std::uint64_t> covering(std::vector<std::uint64_t> masks, const Variant& wanted);

struct BuiltVariant {
  cl::Program program;
  std::uint64_t mask = 0;  // that it was built with
  bool compiled = false;   // just now
};

BuiltVariant build_variant(const cl::Context& context, const std::vector<cl::Device>& devices,
                           const std::string& file, const Variant& wanted, const Builds& builds);

}  // namespace kdray::device
