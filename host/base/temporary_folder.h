// What    A folder that goes with the process: made in the system's folder for temporary files or another
//         one, for nobody but this user.
// Shape   Its name tells the process, so that the next one can remove what a process that was killed has left
//         behind.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "base/temporary.h"

namespace kdray {

// Made as "<prefix><process>-<random>"; null where it can't be made. Removes the folders of that prefix
// whose processes have ended.
std::unique_ptr<Temporary> make_temporary_folder(const std::string& prefix);
std::unique_ptr<Temporary> make_temporary_folder(const std::string& prefix,
                                                 const std::filesystem::path& where);

}  // namespace kdray
