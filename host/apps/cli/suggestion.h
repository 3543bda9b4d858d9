// What    What was meant by a name that kdray doesn't know: one that is nearly the same, or kdray's own where
//         the name is another program's.
#pragma once

#include <string>
#include <vector>

namespace kdray::cli {

// Returns "did you mean 'render'? ", or nothing when none of the names is near. Options begin with "--".
std::string suggestion(const std::string& word, const std::vector<std::string>& names);

}  // namespace kdray::cli
