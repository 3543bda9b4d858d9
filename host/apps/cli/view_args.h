// What    What the command line of kdray view says.
#pragma once

#include <string>
#include <vector>

#include "apps/cli/options.h"
#include "apps/cli/render_options.h"
#include "kdray/kdray.h"

namespace kdray::cli {

struct ViewArgs {
  std::vector<std::string> scenes;
  std::string bind = "127.0.0.1";
  int port = 0;
  bool open = false, no_open = false;
  bool quiet = false, verbose = false;
  double linger = 120;
  LoadOptions load;
  CacheChoice cache;
  TreeOptions tree;
  DeviceOptions device;
  RenderOptions render;
  ViewOptions view;
};

// Shows the page; it is in view_page.cpp or, in a kdray without that module, in view_missing.cpp.
int show_page(ViewArgs& args);

}  // namespace kdray::cli
