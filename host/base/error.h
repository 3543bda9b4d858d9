// What    kdray::Error for the modules. The class itself is public and lives in kdray/error.h.
#pragma once

#include "kdray/error.h"
