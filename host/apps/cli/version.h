// What    What this kdray is and what it was built with.
// Shape   Nothing of the machine, the folder or the time: two builds of the same source have the same text.
#pragma once

#include <string>

namespace kdray::cli {

// Returns lines for --version, the first of which is "kdray 0.1.0".
std::string version_text();

// Returns "2026-11-26": the day of the commit; nothing where the source is no checkout.
std::string commit_date();

}  // namespace kdray::cli
