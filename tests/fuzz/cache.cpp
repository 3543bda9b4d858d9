// The scene cache: an input whose first byte is even is an entry's file, as it is; else the facts of one,
// whose checksums no fuzzer guesses.
#include "accel/cache/entry.h"

#include "fuzz/target.h"

KDRAY_FUZZ(cache, bytes) {
  using namespace kdray;
  fuzz::Input input(bytes);
  if (input.take<std::uint8_t>() % 2 == 0) {
    static const fuzz::MemoryFile file;
    file.put(input.rest());
    return cache::read_entry(file.path(), Hash{}).has_value();
  }
  prepare::Prepared prepared;
  try {
    cache::from_bytes(input.rest(), prepared);
  } catch (const std::exception&) {  // as read_entry() takes it
    return false;
  }
  prepare::Prepared again;
  cache::from_bytes(cache::to_bytes(prepared), again);
  return true;
}
