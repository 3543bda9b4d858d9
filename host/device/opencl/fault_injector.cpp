#include "device/opencl/fault_injector.h"

#include <charconv>

#include "base/error.h"
#include "base/text.h"
#include "device/opencl/opencl.h"

namespace kdray::device {

namespace {

Error bad(const std::string& specification) {
  return Error(ErrorCode::usage, "'" + specification +
                                     "' names no faults; want QUEUE@LAUNCH, as in 1@5,0@9, with :memory, "
                                     ":bug or :input behind it for a failure that is "
                                     "not the device's, or self-test@DEVICE");
}

// Parses a number that takes up all of `text`.
bool parse(std::string_view text, std::uint64_t& number) {
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, number);
  return error == std::errc() && stop == end && !text.empty();
}

}  // namespace

std::optional<FaultInjector::Kind> FaultInjector::kind_of(std::string_view name) {
  if (name == "device") return Kind::device;
  if (name == "memory") return Kind::memory;
  if (name == "bug") return Kind::bug;
  if (name == "input") return Kind::input;
  return std::nullopt;
}

FaultInjector::FaultInjector(const std::string& specification) {
  if (specification.empty()) return;
  for (const std::string& part : split_list(specification)) {
    const std::string_view item = part;
    const std::size_t colon = std::min(item.find(':'), item.size());
    const std::string_view place = item.substr(0, colon);
    const std::size_t at = place.find('@');
    const auto kind = colon < item.size() ? kind_of(item.substr(colon + 1)) : Kind::device;
    std::uint64_t queue = 0, launch = 0, device = 0;
    if (at == std::string_view::npos || !kind) {
      throw bad(specification);
    } else if (item.substr(0, at) == "self-test" && parse(item.substr(at + 1), device)) {
      failing_devices_.insert(device);
    } else if (parse(place.substr(0, at), queue) && parse(place.substr(at + 1), launch) && launch > 0) {
      queues_[queue].failing[launch] = *kind;
    } else {
      throw bad(specification);
    }
  }
}

void FaultInjector::launch(std::size_t queue) {
  const auto found = queues_.find(queue);
  if (found == queues_.end()) return;
  const auto failing = found->second.failing.find(++found->second.launches);
  if (failing == found->second.failing.end()) return;
  constexpr const char* kWhat = "fault on purpose";
  switch (failing->second) {
    case Kind::device:
      throw cl::Error(CL_OUT_OF_RESOURCES, kWhat);
    case Kind::memory:
      throw cl::Error(CL_MEM_OBJECT_ALLOCATION_FAILURE, kWhat);
    case Kind::bug:
      throw cl::Error(CL_INVALID_KERNEL_ARGS, kWhat);
    case Kind::input:
      throw Error(ErrorCode::input, kWhat);
  }
}

}  // namespace kdray::device
