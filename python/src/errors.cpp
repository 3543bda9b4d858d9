#include "errors.h"

#include "interrupt.h"
#include "kdray/error.h"

namespace kdray::python {

namespace {

namespace nb = nanobind;

// The class of kdray/errors.py for a code. By name, so that Python alone says what they derive from.
const char* class_of(ErrorCode code) {
  switch (code) {
    case ErrorCode::input:
      return "InputError";
    case ErrorCode::usage:
      return "UsageError";
    case ErrorCode::no_device:
      return "NoDeviceError";
    case ErrorCode::out_of_memory:
      return "OutOfMemoryError";
    case ErrorCode::cancelled:
      return "CancelledError";
    case ErrorCode::internal:
      break;
  }
  return "InternalError";
}

}  // namespace

void add_errors(nb::module_&) {
  nb::register_exception_translator([](const std::exception_ptr& thrown, void*) {
    try {
      std::rethrow_exception(thrown);
    } catch (const Error& error) {
      if (PyErr_Occurred()) return;  // Ctrl-C: KeyboardInterrupt is on its way already
      if (is_left_by_interpreter()) return PyErr_SetNone(PyExc_SystemExit);
      const nb::object type = nb::module_::import_("kdray.errors").attr(class_of(error.code()));
      PyErr_SetString(type.ptr(), error.what());
    }
  });
}

}  // namespace kdray::python
