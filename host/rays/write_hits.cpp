#include <bit>
#include <cstddef>

#include "base/write_file.h"
#include "rays/npy.h"
#include "rays/npy_header.h"

namespace kdray::rays {

static_assert(std::endian::native == std::endian::little, "NumPy's '<f4' is written as it lies");
static_assert(sizeof(Hit) == 16 && offsetof(Hit, t) == 0 && offsetof(Hit, primitive) == 4 &&
                  offsetof(Hit, u) == 8 && offsetof(Hit, v) == 12,
              "a record of the array is a Hit");

std::string header_of_hits(std::size_t n_hits) {
  return make_header("[('t', '<f4'), ('primitive', '<i4'), ('u', '<f4'), ('v', '<f4')]", n_hits);
}

void write_hits(const std::filesystem::path& file, std::span<const Hit> hits) {
  const std::string header = header_of_hits(hits.size());
  write_atomically(file, [&](const std::filesystem::path& temporary) {
    write_bytes(temporary, file, header);
    write_bytes(temporary, file, {reinterpret_cast<const char*>(hits.data()), hits.size_bytes()});
  });
}

}  // namespace kdray::rays
