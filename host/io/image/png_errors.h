// What    What is done with libpng's errors and warnings, reading and writing: the message goes to where the
//         caller looks for it, and libpng returns to the caller's setjmp.
#pragma once

#include <png.h>

#include <csetjmp>

namespace kdray::image {

// State is what the error pointer points to; it has a string `error`.
template <class State>
[[noreturn]] void keep_error(png_structp png, png_const_charp message) {
  static_cast<State*>(png_get_error_ptr(png))->error = message;
  longjmp(png_jmpbuf(png), 1);
}

inline void ignore_warning(png_structp, png_const_charp) {}

}  // namespace kdray::image
