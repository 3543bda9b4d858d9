#include "bench/ranks/pretend_queue.h"

#include <algorithm>

namespace kdray::bench {

namespace {

constexpr double kShortestSeconds = 0.0003;  // as pdprt/queue.cpp has it

std::size_t tiles_across(const ReplayedFrame& frame) {
  return (frame.width + frame.tile_width - 1) / frame.tile_width;
}

}  // namespace

std::size_t ReplayedFrame::place_of(layout::u32 entry) const {
  return KDRAY_TILE_ROW(entry) * tiles_across(*this) + KDRAY_TILE_COLUMN(entry);
}

void ReplayedFrame::index() {
  by_entry.assign(tiles_across(*this) * ((height + tile_height - 1) / tile_height), 0);
  for (std::size_t i = 0; i < curve.size(); ++i) by_entry[place_of(curve[i])] = tile_seconds[i];
}

ReplayedFrame ReplayedFrame::times(double factor) const {
  ReplayedFrame slower = *this;
  for (auto* const list : {&slower.tile_seconds, &slower.by_entry})
    for (double& seconds : *list) seconds *= factor;
  for (double* const seconds : {&slower.wave_seconds, &slower.prepare_seconds, &slower.begin_seconds,
                                &slower.end_seconds, &slower.deliver_seconds, &slower.take_back_seconds})
    *seconds *= factor;
  return slower;
}

void PretendQueue::begin(pdprt::Tiles& tiles) {
  tiles_ = &tiles;
  state_ = State::waits;
  n_told_ = 0;
}

std::size_t PretendQueue::tiles_of_launch() const {
  return static_cast<std::size_t>(frame_.waves_of_launch / waves_of_tile_) + 1;
}

// As pdprt::Queue::more() has it. Whether there was something to take.
bool PretendQueue::feed(double now) {
  n_told_ += report_.taken - told_of_list_;
  told_of_list_ = report_.taken;
  if (now - since_ > list_seconds_) return false;
  const std::size_t ahead = list_.size() - report_.front;
  const bool measured = report_.taken > 0;
  if (measured) waves_of_tile_ = report_.waves / static_cast<double>(report_.taken);
  const std::size_t shortest =
      list_busy_ > 0
          ? static_cast<std::size_t>(kShortestSeconds / list_busy_ * static_cast<double>(report_.taken)) + 1
          : 1;
  const auto more = tiles_->take(0, {.most = (measured ? 2 : 1) * tiles_of_launch(),
                                     .least = shortest,
                                     .ahead = ahead - std::min(ahead, tiles_of_launch())});
  list_.insert(list_.end(), more.begin(), more.end());
  return !more.empty();
}

void PretendQueue::enqueue(double now) {
  feed(now);
  in_flight_.push_back({list_.size()});
}

std::optional<double> PretendQueue::begin_list(double now) {
  if (tiles_->is_over()) {
    state_ = State::over;
    return std::nullopt;
  }
  if (tiles_->stock() == 0) return std::nullopt;
  state_ = State::begins;
  list_.clear();
  in_flight_.clear();
  report_ = {};
  at_ = told_of_list_ = 0;
  of_tile_ = waves_ = list_busy_ = 0;
  waves_of_tile_ = frame_.guessed_waves;
  since_ = now;
  return frame_.begin_seconds;
}

// Goes through the list as far as the launch's waves and what was listed for it go. Returns its seconds.
double PretendQueue::run_next() {
  ++n_launches_;
  const double most = frame_.waves_of_launch * frame_.wave_seconds;
  double seconds = 0;
  for (const Launch& launch = in_flight_.front(); at_ < launch.listed && seconds < most;) {
    const double left = frame_.seconds_of(list_[at_]) - of_tile_, now = std::min(left, most - seconds);
    seconds += now;
    if (now < left) {
      of_tile_ += now;
    } else {
      ++at_;
      of_tile_ = 0;
    }
  }
  launch_waves_ = seconds / frame_.wave_seconds;
  return std::max(seconds, frame_.launch_seconds);
}

// As Wavefront::render_list() goes on. Returns the next launch's seconds, unless the list is done.
double PretendQueue::end_launch(double now, bool& is_done) {
  const Launch ended = in_flight_.front();
  in_flight_.pop_front();
  waves_ += launch_waves_;
  list_busy_ += launch_waves_ * frame_.wave_seconds;
  busy_ += launch_waves_ * frame_.wave_seconds;
  report_ = {ended.listed, at_, at_, waves_, at_ < ended.listed};
  const bool goes_on = report_.at_work || report_.listed < list_.size();
  is_done = !goes_on && !feed(now);
  if (is_done) return 0;
  enqueue(now);
  return run_next();
}

std::optional<double> PretendQueue::go_on(double now, bool ended, const Deliver& deliver) {
  switch (state_) {
    case State::over:
      return std::nullopt;
    case State::waits:
      return begin_list(now);
    case State::begins:
      if (!ended) return std::nullopt;
      state_ = State::renders;
      enqueue(now);
      enqueue(now);
      return run_next();
    case State::renders: {
      if (!ended) return std::nullopt;
      bool is_done = false;
      const double next = end_launch(now, is_done);
      if (!is_done) return next;
      state_ = State::delivers;
      return deliver_seconds_ * static_cast<double>(list_.size());
    }
    case State::delivers: {
      if (!ended) return std::nullopt;
      n_told_ += list_.size() - told_of_list_;
      told_of_list_ = list_.size();
      if (!list_.empty()) deliver(list_);
      tiles_->done(0);
      state_ = State::waits;
      return begin_list(now);
    }
  }
  return std::nullopt;
}

}  // namespace kdray::bench
