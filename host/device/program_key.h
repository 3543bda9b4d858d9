// What    The key that a built program is kept under: a hash of all that has a say in its binary.
// Shape   The whole source and the options; the platform and the device with all their versions (PoCL's names
//         its LLVM); on a CPU the processor's model and features, since a home directory may be shared by
//         several machines; PoCL's environment variables, which change what it makes.
#pragma once

#include <string>

#include "base/hash.h"
#include "device/opencl.h"

namespace kdray::device {

// All that a key is made of but source and options, as text. Throws cl::Error.
std::string identity_of(const cl::Device& device);

Hash program_key(const std::string& identity, const std::string& source, const std::string& options);

}  // namespace kdray::device
