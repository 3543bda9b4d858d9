// What    The key that a built program is kept under: a hash of all that has a say in its binary.
// Shape   The whole source and the options; the platform and the device with all their versions (PoCL's names
//         its LLVM); on a CPU the processor's model and features, since a home directory may be shared by
//         several machines; PoCL's environment variables, which change what it makes.
//         A program of which there are variants (variant.h) is filed under its family, which is all of that
//         but the feature mask, and its mask: names of files are the only index that there is.
#pragma once

#include <cstdint>
#include <string>

#include "base/hash.h"
#include "device/opencl/opencl.h"

namespace kdray::device {

// All that a key is made of but source and options, as text. Throws cl::Error.
std::string identity_of(const cl::Device& device);

Hash program_key(const std::string& identity, const std::string& source, const std::string& options);

// What an entry is checked by, and what its file is named by.
struct ProgramKey {
  Hash content;
  Hash name;

  ProgramKey(const Hash& key) : content(key), name(key) {}  // NOLINT: a key that is its own name
  ProgramKey(const Hash& whole, std::uint64_t family, std::uint64_t mask)
      : content(whole), name{family, mask} {}
};

// `options`: all but the mask, as Variant has them.
std::uint64_t family_of(const std::string& identity, const std::string& source, const std::string& options);
ProgramKey variant_key(const std::string& identity, const std::string& source, const std::string& options,
                       std::uint64_t mask);

}  // namespace kdray::device
