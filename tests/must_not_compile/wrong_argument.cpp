// Must not compile with KDRAY_TEST_FAULT 1 to 3: arguments of kernels that are set wrongly. (With 0 it must.)
#include "device/opencl/kernel.h"

void set(kdray::device::Kernel<kdray::kernels::Shade>& shade, const cl::Buffer& buffer) {
  using kdray::kernels::Shade;
  shade.set(Shade::film, buffer).set(Shade::first_light, cl_uint{0});
#if KDRAY_TEST_FAULT == 1
  shade.set(Shade::last_light, cl_uint{0});  // no such argument
#elif KDRAY_TEST_FAULT == 2
  shade.set(Shade::first_light, buffer);  // of another type
#elif KDRAY_TEST_FAULT == 3
  shade.set(kdray::kernels::Add::film, buffer);  // another kernel's
#endif
}
