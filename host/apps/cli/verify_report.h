// What    What kdray verify found, in words and as JSON.
#pragma once

#include <string>

#include "apps/cli/stats.h"
#include "apps/verify/verify.h"

namespace kdray::cli {

// Returns several lines, each beginning with "[ok]", "[note]" (about the mesh) or "[bad]" (about kdray).
std::string findings_in_words(const verify::Findings& found);

// Returns the result in one line.
std::string verdict(const verify::Findings& found);

// Returns the first hundred findings of each kind; places are those of the file.
Json findings_as_json(const verify::Findings& found);

}  // namespace kdray::cli
