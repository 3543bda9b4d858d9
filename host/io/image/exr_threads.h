// What    How many threads OpenEXR may use: all of the machine's, asked for once per process.
#pragma once

namespace kdray::image {

int exr_threads();

}  // namespace kdray::image
