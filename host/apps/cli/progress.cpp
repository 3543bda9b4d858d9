#include "apps/cli/progress.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <string>

#include "apps/cli/message.h"

namespace kdray::cli {

namespace {

constexpr double kQuietStart = 0.3;  // seconds: a bar that would be gone at once only flickers
constexpr double kBarEvery = 0.1;    // seconds

int columns() {
  winsize size{};
  if (::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0) return 80;
  return size.ws_col;
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

}  // namespace kdray::cli
