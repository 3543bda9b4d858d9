#include "device/faults.h"

#include <charconv>

#include "base/error.h"
#include "device/opencl.h"

namespace kdray::device {

namespace {

Error bad(const std::string& specification) {
  return Error(
      ErrorCode::usage,
      "'" + specification + "' names no faults; want QUEUE@LAUNCH, as in 1@5,0@9, or self-test@DEVICE");
}

// The number that `text` is, all of it.
bool parse(std::string_view text, std::uint64_t& number) {
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, number);
  return error == std::errc() && stop == end && !text.empty();
}

}  // namespace

Faults::Faults(const std::string& specification) {
  std::string_view rest = specification;
  while (!rest.empty()) {
    const std::size_t comma = std::min(rest.find(','), rest.size());
    const std::string_view item = rest.substr(0, comma);
    const std::size_t at = item.find('@');
    std::uint64_t queue = 0, launch = 0, device = 0;
    if (item.substr(0, at) == "self-test" && at != std::string_view::npos &&
        parse(item.substr(at + 1), device)) {
      failing_devices_.insert(device);
    } else if (at == std::string_view::npos || !parse(item.substr(0, at), queue) ||
               !parse(item.substr(at + 1), launch) || launch == 0) {
      throw bad(specification);
    } else {
      queues_[queue].failing.insert(launch);
    }
    rest.remove_prefix(std::min(comma + 1, rest.size()));
  }
}

void Faults::launch(std::size_t queue) {
  const auto found = queues_.find(queue);
  if (found == queues_.end()) return;
  const std::uint64_t number = ++found->second.launches;
  if (found->second.failing.contains(number)) throw cl::Error(CL_OUT_OF_RESOURCES, "fault on purpose");
}

}  // namespace kdray::device
