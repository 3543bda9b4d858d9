// What    Stands in for the page in a kdray that was built without what it needs.
#include "apps/cli/view_args.h"

namespace kdray::cli {

int show_page(ViewArgs&) {
  throw Error(
      ErrorCode::input,
      "this kdray was built without the page; install libboost-dev and libturbojpeg0-dev, and build it anew");
}

}  // namespace kdray::cli
