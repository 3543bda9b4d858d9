#include "device/tuning/database.h"
#include "fuzz/target.h"

KDRAY_FUZZ(tunings, bytes) {
  using namespace kdray;
  return fuzz::is_read([&] {
    const auto read = tuning::Database::parse(std::string(bytes), "tune.json");
    const auto again = tuning::Database::parse(read.text(), "again");
    if (again.entries().size() != read.entries().size()) fuzz::fail("other tunings when read again");
  });
}
