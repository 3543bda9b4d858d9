#include "apps/cli/build_notice.h"

#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <utility>

#include "apps/cli/message.h"

namespace kdray::cli {

namespace {

constexpr auto kNoticeEvery = std::chrono::milliseconds(500);

void draw_line(const std::string& line) {
  std::fputs(("\r" + line + "\033[K").c_str(), stderr);
  std::fflush(stderr);
}

}  // namespace

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

BuildNotice::Output notice_on_stderr(bool quiet) {
  BuildNotice::Output output;
  if (quiet) return output;
  if (can_redraw())
    output.draw = draw_line;
  else
    output.say = [](const std::string& text) { say(text); };
  return output;
}

}  // namespace kdray::cli
