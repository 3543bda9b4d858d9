// What    What kdray verify found, in words and as JSON.
#pragma once

#include <string>

#include "apps/cli/stats.h"
#include "apps/verify/verify.h"

namespace kdray::cli {

// Several lines, each beginning with "[ok]", "[note]" (about the mesh) or "[bad]" (about kdray).
std::string findings_in_words(const verify::Findings& found);

// One line that says what it all comes to.
std::string verdict(const verify::Findings& found);

// Places are the file's; of each kind of finding the first hundred.
Json findings_as_json(const verify::Findings& found);

}  // namespace kdray::cli
