// What    --restarts: starts this very command again, without that option, in a process of its own, and once
//         more from its checkpoint whenever a signal has ended it.
// Shape   A run that ends by itself, well or not, is the end. So is one that somebody ended on purpose
//         (SIGINT, SIGTERM, SIGHUP, SIGQUIT). The run goes when this process goes, whatever ended it.
#pragma once

#include "apps/cli/checkpoint_options.h"

namespace kdray::cli {

// Returns the last run's exit code.
int run_again(const CheckpointChoice& choice);

}  // namespace kdray::cli
