#include "engine/odprt/band.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <numeric>
#include <thread>

#include "base/error.h"
#include "base/timer.h"
#include "device/opencl/opencl_error.h"

namespace kdray::odprt {

namespace {

void check(const Worker& worker) {
  const auto n_lost = std::accumulate(worker.traffic().begin(), worker.traffic().end(), std::uint64_t{0},
                                      [](std::uint64_t n, const layout::Traffic& t) { return n + t.n_lost; });
  wavefront::check(wavefront::sum_of(worker.slices()), n_lost);
}

std::uint64_t sum_of(std::span<const layout::Traffic> traffic, layout::u32 layout::Traffic::*count) {
  std::uint64_t sum = 0;
  for (const layout::Traffic& t : traffic) sum += t.*count;
  return sum;
}

}  // namespace

BandRun::BandRun(const Request& request, Crew& crew, BandWork& band)
    : request_(request),
      crew_(crew),
      band_(band),
      exchange_(crew.plan, request.table, crew.owner, crew.direct, crew.outboxes, band.shares),
      tiles_left_(crew.workers.size()),
      sent_(crew.workers.size(),
            std::vector<Mail>(crew.owner.size(), Mail(crew.plan.n_slices, crew.plan.outbox.ray_fields))) {
  if (request.table.ranks == nullptr) return;
  const RaysKnown known{.first_part = static_cast<std::uint32_t>(request.table.own_first()),
                        .n_parts = static_cast<std::uint32_t>(crew.workers.size()),
                        .n_all_parts = static_cast<std::uint32_t>(crew.owner.size()),
                        .n_slices = crew.plan.n_slices,
                        .ray_fields = crew.plan.outbox.ray_fields,
                        .max_depth = request.frame.max_depth,
                        .first_pixel = band.first_pixel,
                        .n_pixels = band.n_places};
  post_.emplace(request.table, band.list, known, crew.plan, exchange_, band.shares, band.is_entry);
}

void BandRun::run(const std::function<void(double)>& progress) {
  n_serving_ = crew_.workers.size();
  std::vector<std::jthread> threads;
  for (std::size_t q = 0; q < crew_.workers.size(); ++q)
    threads.emplace_back([this, q] {
      try {
        crew_.workers[q]->begin({band_.first_pixel, band_.n_places, band_.samples});
        take_turns(q);
      } catch (...) {
        exchange_.fail(q, std::current_exception());
      }
      const std::lock_guard lock(mutex_);
      --n_serving_;
      ended_.notify_one();
    });
  try {
    wait(progress);
  } catch (...) {
    // The caller's progress threw: nobody goes on.
    exchange_.fail(crew_.workers.size(), std::current_exception());
    throw;
  }
}

// The messages of other ranks are looked at much more often.
void BandRun::wait(const std::function<void(double)>& progress) {
  using namespace std::chrono_literals;
  const Timer timer;
  double told = 0;
  std::unique_lock lock(mutex_);
  const auto ended = [this] { return n_serving_ == 0; };
  while (!ended_.wait_for(lock, post_ ? 500us : 20ms, ended)) {
    if (post_) post_->step();
    const double now = timer.seconds();
    if (now > band_.seconds) close();
    if (!progress || now < told + 0.02) continue;
    told = now;
    auto left = static_cast<double>(band_.shares.left());
    for (const auto& n : tiles_left_) left += n;
    left *= request_.table.place().ranks;  // others', about
    const auto all = static_cast<double>(std::max<std::size_t>(band_.n_entries, 1));
    progress(std::clamp(1 - left / all, 0.0, 1.0));
  }
  if (post_) band_.left = post_->left();
}

// The time is over: what is left is not begun.
void BandRun::close() {
  band_.seconds = kForever;
  if (post_)
    post_->close();
  else
    band_.left = band_.shares.close();
}

void BandRun::take_turns(std::size_t queue) {
  QueueState state;
  const auto first = std::find(crew_.owner.begin(), crew_.owner.end(), request_.table.own_first() + queue);
  state.part = static_cast<std::uint32_t>(first - crew_.owner.begin());
  crew_.workers[queue]->serve(crew_.stores[queue]->get(state.part), request_.census_every);
  Mail pending(crew_.plan.n_slices, crew_.plan.outbox.ray_fields);
  while (const std::optional<Turn> turn = exchange_.next_turn(queue, state))
    take_turn(queue, *turn, state, pending);
}

// Takes as many entries as a launch may begin, and fewer when the end is near.
void BandRun::take_entries(std::size_t queue) {
  Shares& shares = band_.shares;
  Worker& worker = *crew_.workers[queue];
  const std::size_t n = std::min<std::size_t>(worker.launch_tiles(), shares.left() / (4 * shares.n_queues()));
  const std::size_t wanted = std::max<std::size_t>(n, crew_.plan.n_slices), has = worker.tiles_left();
  if (has < wanted) worker.add(shares.take(queue, wanted - has));
  tiles_left_[queue] = worker.tiles_left();
}

void BandRun::take_turn(std::size_t queue, const Turn& turn, QueueState& state, Mail& pending) {
  Worker& worker = *crew_.workers[queue];
  if (turn.part != state.part) change_part(queue, turn.part, state, pending);
  const double start = request_.timeline ? request_.timeline->now() : 0;
  for (const Letter& letter : turn.letters) worker.receive(*letter.outbox, turn.part);
  exchange_.take_mail(turn.part, pending);
  if (pending.n > 0) worker.receive(pending);
  if (turn.outbox) {
    take_entries(queue);
    launch(queue, turn, state);
  } else {
    worker.finish();
  }
  check(worker);
  tiles_left_[queue] = worker.tiles_left();
  state.has_tiles = tiles_left_[queue] > 0;
  state.has_rays = worker.n_waiting() + pending.n > 0;
  state.progressed = state.progressed || !turn.letters.empty();
  if (request_.timeline && turn.outbox) {
    request_.timeline->add(
        static_cast<int>(request_.queues[queue].number), fmt::format("part {}", turn.part), start,
        request_.timeline->now(),
        {{"waves", static_cast<double>(sum_of(worker.traffic(), &layout::Traffic::n_waves))},
         {"rays", static_cast<double>(sum_of(worker.traffic(), &layout::Traffic::n_traced))},
         {"messages", static_cast<double>(turn.letters.size())},
         {"rays_out", static_cast<double>(turn.outbox->n_all())}});
  }
  hand_over(queue, turn, state);
}

// The rays of the part that is left go back to its mail, and so do those that the pools hold.
void BandRun::change_part(std::size_t queue, std::uint32_t part, QueueState& state, Mail& pending) {
  Worker& worker = *crew_.workers[queue];
  worker.stash(pending);
  exchange_.put_mail(state.part, pending);
  worker.serve(crew_.stores[queue]->get(part), 0);
  state.part = part;
}

void BandRun::launch(std::size_t queue, const Turn& turn, QueueState& state) {
  Worker& worker = *crew_.workers[queue];
  if (request_.faults) request_.faults->launch(request_.queues[queue].number);
  worker.launch(turn.grants, *turn.outbox);
  QueueReport& report = crew_.reports[queue];
  const std::uint64_t n_waves = sum_of(worker.traffic(), &layout::Traffic::n_waves);
  ++report.launches;
  report.waves += n_waves;
  report.traced += sum_of(worker.traffic(), &layout::Traffic::n_traced);
  state.progressed = n_waves > 0;
}

// Whether it holds something for parts that don't read it themselves.
bool BandRun::sends_mail(std::size_t queue, const Outbox& outbox) const {
  if (outbox.shape().n_places == 1) return outbox.n_all() > 0;  // for all of them
  for (std::uint32_t part = 0; part < crew_.owner.size(); ++part)
    if (!exchange_.direct(queue, part) && outbox.n_rays(part) + outbox.n_shadow_rays(part) > 0) return true;
  return false;
}

void BandRun::hand_over(std::size_t queue, const Turn& turn, const QueueState& state) {
  Worker& worker = *crew_.workers[queue];
  std::vector<Mail>& sent = sent_[queue];
  const auto mail_of = [&](std::uint32_t part) {
    return exchange_.direct(queue, part) ? nullptr : &sent[part];
  };
  if (turn.outbox && sends_mail(queue, *turn.outbox)) worker.copy_out(*turn.outbox, mail_of);
  exchange_.end_turn(queue, turn, worker.traffic(), state, sent);
}

}  // namespace kdray::odprt
