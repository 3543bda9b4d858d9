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

template <class Count>
std::uint64_t sum_of(std::span<const layout::Traffic> traffic, Count layout::Traffic::*count) {
  std::uint64_t sum = 0;
  for (const layout::Traffic& t : traffic) sum += t.*count;
  return sum;
}

}  // namespace

BandRun::BandRun(const Request& request, WorkerPool& pool, BandWork& band)
    : request_(request),
      pool_(pool),
      band_(band),
      exchange_(pool.plan, request.table, pool.owner, pool.direct, pool.outboxes, band.shares),
      tiles_left_(pool.workers.size()),
      sent_(pool.workers.size(),
            std::vector<HostRayQueue>(pool.owner.size(),
                                      HostRayQueue(pool.plan.n_slices, pool.plan.outbox.ray_fields))) {
  if (request.table.ranks == nullptr) return;
  const RaysKnown known{.first_part = static_cast<std::uint32_t>(request.table.own_first()),
                        .n_parts = static_cast<std::uint32_t>(pool.workers.size()),
                        .n_all_parts = static_cast<std::uint32_t>(pool.owner.size()),
                        .n_slices = pool.plan.n_slices,
                        .ray_fields = pool.plan.outbox.ray_fields,
                        .max_depth = request.frame.max_depth,
                        .first_pixel = band.first_pixel,
                        .n_pixels = band.n_places};
  rank_exchange_.emplace(request.table, band.list, known, pool.plan, exchange_, band.shares, band.is_entry);
}

void BandRun::run(const std::function<void(double)>& progress) {
  n_serving_ = pool_.workers.size();
  std::vector<std::jthread> threads;
  for (std::size_t q = 0; q < pool_.workers.size(); ++q)
    threads.emplace_back([this, q] {
      try {
        pool_.workers[q]->begin({band_.first_pixel, band_.n_places, band_.samples});
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
    exchange_.fail(pool_.workers.size(), std::current_exception());
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
  while (!ended_.wait_for(lock, rank_exchange_ ? 500us : 20ms, ended)) {
    if (rank_exchange_) rank_exchange_->step();
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
  if (rank_exchange_) band_.left = rank_exchange_->left();
}

// The time is over: what is left is not begun.
void BandRun::close() {
  band_.seconds = frame::kForever;
  if (rank_exchange_)
    rank_exchange_->close();
  else
    band_.left = band_.shares.close();
}

void BandRun::take_turns(std::size_t queue) {
  QueueState state;
  const auto first = std::find(pool_.owner.begin(), pool_.owner.end(), request_.table.own_first() + queue);
  state.part = static_cast<std::uint32_t>(first - pool_.owner.begin());
  pool_.workers[queue]->serve(pool_.stores[queue]->get(state.part), request_.census_every);
  HostRayQueue pending(pool_.plan.n_slices, pool_.plan.outbox.ray_fields);
  while (const std::optional<Turn> turn = exchange_.next_turn(queue, state))
    take_turn(queue, *turn, state, pending);
}

// Takes as many entries as a launch may begin, and fewer when the end is near. Where every ray has a
// work-item a launch takes long however little it does, so they are fewer. One queue takes all from the
// beginning.
void BandRun::take_entries(std::size_t queue) {
  Shares& shares = band_.shares;
  Worker& worker = *pool_.workers[queue];
  const bool per_ray = pool_.plan.per_ray;
  const std::size_t n_queues = shares.n_queues(), most = worker.launch_tiles();
  const std::size_t of_left = n_queues == 1 ? 1 : (per_ray ? 2 : 4) * n_queues;
  const std::size_t least = per_ray ? most / 16 + 1 : pool_.plan.n_slices;
  const std::size_t wanted = std::max(std::min(most, shares.left() / of_left), least);
  const std::size_t has = worker.tiles_left();
  if (has < wanted) worker.add(shares.take(queue, wanted - has));
  tiles_left_[queue] = worker.tiles_left();
}

void BandRun::take_turn(std::size_t queue, const Turn& turn, QueueState& state, HostRayQueue& pending) {
  Worker& worker = *pool_.workers[queue];
  if (turn.part != state.part) change_part(queue, turn.part, state, pending);
  const double start = request_.timeline ? request_.timeline->now() : 0;
  for (const DeviceMessage& message : turn.messages) worker.receive(*message.outbox, turn.part);
  exchange_.take_host_rays(turn.part, pending);
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
  state.progressed = state.progressed || !turn.messages.empty();
  if (request_.timeline && turn.outbox) {
    request_.timeline->add(
        static_cast<int>(request_.queues[queue].number), fmt::format("part {}", turn.part), start,
        request_.timeline->now(),
        {{"waves", static_cast<double>(sum_of(worker.traffic(), &layout::Traffic::n_waves))},
         {"rays", static_cast<double>(sum_of(worker.traffic(), &layout::Traffic::n_traced))},
         {"messages", static_cast<double>(turn.messages.size())},
         {"rays_out", static_cast<double>(turn.outbox->n_all())}});
  }
  hand_over(queue, turn, state);
}

// The rays of the part that is left go back to the host's memory, and so do those that the pools hold.
void BandRun::change_part(std::size_t queue, std::uint32_t part, QueueState& state, HostRayQueue& pending) {
  Worker& worker = *pool_.workers[queue];
  worker.stash(pending);
  exchange_.put_host_rays(state.part, pending);
  worker.serve(pool_.stores[queue]->get(part), 0);
  state.part = part;
}

void BandRun::launch(std::size_t queue, const Turn& turn, QueueState& state) {
  Worker& worker = *pool_.workers[queue];
  if (request_.fault_injector) request_.fault_injector->launch(request_.queues[queue].number);
  worker.launch(turn.credits, *turn.outbox);
  QueueReport& report = pool_.reports[queue];
  const std::uint64_t n_waves = sum_of(worker.traffic(), &layout::Traffic::n_waves);
  ++report.launches;
  report.waves += n_waves;
  report.rays += sum_of(worker.traffic(), &layout::Traffic::n_traced);
  state.progressed = n_waves > 0;
}

// Whether it holds something for parts that don't read it themselves.
bool BandRun::sends_to_host(std::size_t queue, const Outbox& outbox) const {
  if (outbox.shape().n_places == 1) return outbox.n_all() > 0;  // for all of them
  for (std::uint32_t part = 0; part < pool_.owner.size(); ++part)
    if (!exchange_.direct(queue, part) && outbox.n_rays(part) + outbox.n_shadow_rays(part) > 0) return true;
  return false;
}

void BandRun::hand_over(std::size_t queue, const Turn& turn, const QueueState& state) {
  Worker& worker = *pool_.workers[queue];
  std::vector<HostRayQueue>& sent = sent_[queue];
  const auto host_rays_of = [&](std::uint32_t part) {
    return exchange_.direct(queue, part) ? nullptr : &sent[part];
  };
  if (turn.outbox && sends_to_host(queue, *turn.outbox)) worker.copy_out(*turn.outbox, host_rays_of);
  exchange_.end_turn(queue, turn, worker.traffic(), state, sent);
}

}  // namespace kdray::odprt
