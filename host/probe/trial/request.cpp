#include "probe/trial/request.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <exception>
#include <string_view>

#include "device/opencl/context.h"
#include "device/opencl/opencl_error.h"
#include "device/opencl/platform.h"
#include "probe/selftest/self_test.h"

namespace kdray::trial {

namespace {

// Writes a whole line; the text may be anything that a driver says.
void report(std::string line) {
  std::ranges::replace_if(
      line, [](unsigned char c) { return c < ' '; }, ' ');
  line += '\n';
  for (std::string_view rest = line; !rest.empty();) {
    const ssize_t n = ::write(Child::kReport, rest.data(), rest.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) ::_exit(1);  // nobody is listening
    rest.remove_prefix(static_cast<std::size_t>(n));
  }
}

// Turns an error's text into what is wrong, in words that follow the device's name, without the error's
// advice.
std::string as_fault(std::string text, const std::string& name) {
  for (const char* const advice : {"; try another device", "; `kdray doctor`"})
    text = text.substr(0, text.find(advice));
  return text.starts_with(name + " ") ? text.substr(name.size() + 1) : "fails the self-test: " + text;
}

std::string on_device(const device::FoundDevice& found) {
  try {
    const device::Context context(std::to_string(found.info.number), 1);
    const std::string fault = selftest::fault_of(context);
    if (!fault.empty()) return kFailed + ("fails the self-test: " + fault);
    return kPassed + selftest::passed_with(context.simd()).text;
  } catch (const Error& error) {
    if (error.code() != ErrorCode::no_device) return kNone + std::string(error.what());
    return kFailed + as_fault(error.what(), found.info.name);
  } catch (const cl::Error& error) {
    return kFailed + as_fault(device::translate(error, "testing").what(), found.info.name);
  }
}

std::string on_picture(const device::FoundDevice& found, const TestPicture& test) {
  try {
    const std::string wrong = test(found.info.number);
    return wrong.empty() ? kPassed : kFailed + wrong;
  } catch (const Error& error) {
    return kFailed + as_fault(error.what(), found.info.name);
  }
}

std::string outcome(const TrialRequest& request, const TestPicture& test_picture) {
  const std::vector<device::FoundDevice> all = device::find_devices();
  if (request.subject == Subject::driver) return kPassed;
  for (const device::FoundDevice& found : all)
    if (found.info.usable && in_hex(selftest::verdict_key(found.device)) == request.key)
      return request.subject == Subject::device ? on_device(found) : on_picture(found, test_picture);
  return std::string(kNone) + "there is no such device";
}

}  // namespace

std::optional<TrialRequest> request_of(std::span<const char* const> arguments) {
  if (arguments.size() != 5 || arguments[1] != std::string_view(kTry)) return std::nullopt;
  const std::string_view what = arguments[2], parent = arguments[4];
  TrialRequest request{Subject::device, arguments[3], 0};
  if (what == "driver")
    request.subject = Subject::driver;
  else if (what == "picture")
    request.subject = Subject::picture;
  else if (what != "device")
    return std::nullopt;
  const auto [end, error] = std::from_chars(parent.data(), parent.data() + parent.size(), request.parent);
  if (error != std::errc() || end != parent.data() + parent.size()) return std::nullopt;
  return request;
}

void try_it(const TrialRequest& request, const TestPicture& test_picture) {
  live_as_child_of(request.parent);
  report(kBegun);
  std::string line;
  try {
    line = outcome(request, test_picture);
  } catch (const std::exception& error) {
    line = std::string(kNone) + error.what();
  }
  report(line);
  ::_exit(0);
}

}  // namespace kdray::trial
