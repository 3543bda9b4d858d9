#include "fuzz/view_server.h"

KDRAY_FUZZ(http, bytes) {
  return kdray::fuzz::serve_bytes(std::string(bytes)).answer.find(" 200 ") != std::string::npos;
}
