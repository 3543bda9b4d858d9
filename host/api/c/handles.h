// What    What the opaque handles of kdray.h are.
#pragma once

#include "kdray.h"
#include "kdray/kdray.h"

struct kdray_scene {
  kdray::Scene scene;
  kdray::CommitReport report;  // of the last commit
};
struct kdray_cancel {
  kdray::Cancel cancel;
};
struct kdray_all_hits {
  kdray::AllHits hits;
};
