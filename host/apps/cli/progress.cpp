#include "apps/cli/progress.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <system_error>
#include <utility>

#include "apps/cli/output.h"
#include "kdray/kdray.h"

namespace kdray::cli {

namespace {

constexpr double kQuietStart = 0.3;  // seconds: a bar that would be gone at once only flickers
constexpr double kBarEvery = 0.1;    // seconds

int columns() {
  winsize size{};
  if (::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0) return 80;
  return size.ws_col;
}

constexpr auto kNoticeEvery = std::chrono::milliseconds(500);

void draw_line(const std::string& line) {
  std::fputs(("\r" + line + "\033[K").c_str(), stderr);
  std::fflush(stderr);
}

}  // namespace

Progress::Progress(bool quiet) : shown_here_(!quiet && can_redraw()) {}

void Progress::update(double share) {
  if (!shown_here_ || since_start_.seconds() < kQuietStart) return;
  if (drawn_ && since_draw_.seconds() < kBarEvery) return;
  share = std::clamp(share, 0.0, 1.0);
  const double elapsed = since_start_.seconds();
  const std::string left = share > 0 ? seconds_in_words(elapsed * (1 - share) / share) + " left" : "";
  const int width = std::clamp(columns() - 30, 10, 60);
  const int full = static_cast<int>(share * width);
  const std::string line = fmt::format("\r[{}{}] {:3.0f} %  {}\033[K", std::string(full, '#'),
                                       std::string(width - full, '.'), share * 100, left);
  std::fwrite(line.data(), 1, line.size(), stderr);
  std::fflush(stderr);
  drawn_ = true;
  since_draw_.restart();
}

void Progress::clear() {
  if (drawn_) std::fputs("\r\033[K", stderr);
  drawn_ = false;
}

BuildNotice::BuildNotice(Output output, double patience_seconds)
    : output_(std::move(output)), patience_(patience_seconds), thread_([this] { watch(); }) {}

BuildNotice::~BuildNotice() {
  mute();
  thread_.join();
}

void BuildNotice::mute() {
  const std::lock_guard lock(mutex_);
  ended_ = true;
  changed_.notify_all();
}

void BuildNotice::tell(bool begins) {
  const std::lock_guard lock(mutex_);
  if (begins && at_work_++ == 0) since_begin_.restart();
  if (!begins && --at_work_ == 0) spent_ += since_begin_.seconds();
  changed_.notify_all();
}

void BuildNotice::watch() {
  std::unique_lock lock(mutex_);
  bool said = false, drawn = false;
  while (!ended_) {
    if (at_work_ == 0) {
      if (std::exchange(drawn, false)) output_.draw("");
      changed_.wait(lock);
      continue;
    }
    const double seconds = spent_ + since_begin_.seconds();
    if (seconds < patience_) {
      changed_.wait_for(lock, std::chrono::duration<double>(patience_ - seconds));
      continue;
    }
    if (output_.draw) {
      output_.draw(fmt::format("{}: {:.0f} s", output_.text, seconds));
      drawn = true;
    } else if (!std::exchange(said, true) && output_.say) {
      output_.say(output_.text);
    }
    changed_.wait_for(lock, kNoticeEvery);
  }
  if (drawn) output_.draw("");
}

bool keeps_kernels() {
  const char* const set = std::getenv("KDRAY_CACHE_DIR");
  if (set != nullptr && *set == '\0') return true;  // in the runtime's own cache
  std::error_code error;
  std::filesystem::path folder = std::filesystem::absolute(default_program_folder(), error);
  if (folder.empty() || error) return false;
  while (folder.has_relative_path() && !std::filesystem::exists(folder, error)) folder = folder.parent_path();
  return ::access(folder.c_str(), W_OK) == 0;
}

BuildNotice::Output notice_on_stderr(bool quiet) {
  BuildNotice::Output output;
  if (!keeps_kernels())
    output.text =
        "compiling kernels for this scene and device; set KDRAY_CACHE_DIR to a folder of yours to keep them";
  if (quiet) return output;
  if (can_redraw())
    output.draw = draw_line;
  else
    output.say = [](const std::string& text) { say(text); };
  return output;
}

}  // namespace kdray::cli
