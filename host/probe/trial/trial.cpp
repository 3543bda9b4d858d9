#include "probe/trial/trial.h"

#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdlib>
#include <string_view>
#include <system_error>

#include "probe/trial/request.h"

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

}  // namespace kdray::trial
