#include "probe/trial/trial.h"

#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <charconv>
#include <cstdlib>
#include <exception>
#include <string_view>
#include <system_error>

#include "device/opencl/context.h"
#include "device/opencl/opencl_error.h"
#include "device/opencl/platform.h"
#include "probe/selftest/self_test.h"

namespace kdray::trial {

namespace fs = std::filesystem;

namespace {

std::atomic<bool> tries_itself{false};

constexpr const char* kName = "kdray";

bool can_be_run(const fs::path& program) {
  std::error_code error;
  return fs::is_regular_file(program, error) && ::access(program.c_str(), X_OK) == 0;
}

fs::path beside_this_program() {
  std::error_code error;
  const fs::path own = fs::read_symlink("/proc/self/exe", error);
  return own.empty() ? own : own.parent_path() / kName;
}

std::optional<fs::path> in_path() {
  const char* const set = std::getenv("PATH");
  std::string_view rest = set ? set : "";
  while (!rest.empty()) {
    const std::string_view folder = rest.substr(0, rest.find(':'));
    rest.remove_prefix(std::min(folder.size() + 1, rest.size()));
    const fs::path program = fs::path(folder) / kName;
    if (program.is_absolute() && can_be_run(program)) return program;
  }
  return std::nullopt;
}

}  // namespace

void this_program_tries() {
  tries_itself = true;
}

// The link /proc/self/exe leads to this program even where an upgrade has replaced its file meanwhile.
std::optional<fs::path> program() {
  if (tries_itself) return "/proc/self/exe";
  if (const char* const set = std::getenv("KDRAY_PROGRAM"); set && *set)
    return can_be_run(set) ? std::optional<fs::path>(set) : std::nullopt;
  for (const fs::path& program : {beside_this_program(), fs::path(KDRAY_INSTALLED_PROGRAM)})
    if (can_be_run(program)) return program;
  return in_path();
}

namespace {

constexpr double kPictureLimit = 4;  // times as long: it takes the compiling of a whole render

// What a child is told to do, and what that is called when it went wrong; in the order of Subject.
struct Words {
  const char* asked;
  const char* in;
  const char* to;
};
constexpr std::array<Words, 3> kWords = {{
    {"driver", "when it is asked for its devices", "to list its devices"},
    {"device", "in the self-test", "for the self-test"},
    {"picture", "in the test picture", "for the test picture"},
}};

const Words& words_for(Subject subject) {
  return kWords[static_cast<std::size_t>(subject)];
}

// Whether such a signal comes from outside: from a user, a batch system, or the kernel that is out of memory.
bool is_sent(int signal) {
  constexpr std::array kSent = {SIGKILL, SIGTERM, SIGINT, SIGHUP, SIGQUIT, SIGXCPU};
  return std::ranges::find(kSent, signal) != kSent.end();
}

// Returns the last whole line of a report.
std::string_view last_line(std::string_view report) {
  report = report.substr(0, report.rfind('\n') + 1);
  if (report.empty()) return report;
  report.remove_suffix(1);
  return report.substr(report.rfind('\n') + 1);
}

std::optional<std::string> behind(std::string_view word, std::string_view line) {
  if (!line.starts_with(word)) return std::nullopt;
  return std::string(line.substr(word.size()));
}

Outcome failed(const std::string& text, bool lasting = true) {
  return {device::Verdict{false, text}, lasting};
}

}  // namespace

double time_limit(double usual) {
  const char* const set = std::getenv("KDRAY_TRIAL_SECONDS");
  const double seconds = set ? std::strtod(set, nullptr) : 0;
  return seconds > 0 && seconds <= 1e6 ? seconds : usual;
}

Outcome outcome_of(Subject subject, const ChildEnd& end, double limit_seconds) {
  const std::string_view line = last_line(end.report);
  if (const auto text = behind(kPassed, line)) return {device::Verdict{true, *text}};
  if (const auto text = behind(kFailed, line)) return failed(*text);
  if (line != kBegun) return {};
  const Words& words = words_for(subject);
  if (end.timed_out) return failed(fmt::format("takes longer than {} s {}", limit_seconds, words.to));
  if (is_sent(end.signal))
    return failed(fmt::format("was stopped by {} {}", signal_name(end.signal), words.in), false);
  if (end.signal != 0) return failed(fmt::format("crashes ({}) {}", signal_name(end.signal), words.in));
  return failed(fmt::format("ends the program {}", words.in));
}

Trial::Trial(Subject subject, const Hash& key, const std::map<std::string, std::string>& environment,
             double usual_seconds)
    : subject_(subject),
      limit_seconds_(time_limit(usual_seconds) * (subject == Subject::picture ? kPictureLimit : 1)) {
  if (const auto found = program())
    child_ = std::make_unique<Child>(
        ChildOptions{.program = *found,
                     .arguments = {kTry, words_for(subject).asked, in_hex(key), std::to_string(::getpid())},
                     .environment = environment,
                     .limit_seconds = limit_seconds_});
}

const Outcome& Trial::outcome() {
  if (!outcome_) outcome_ = child_ ? outcome_of(subject_, child_->wait(), limit_seconds_) : Outcome{};
  return *outcome_;
}

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
