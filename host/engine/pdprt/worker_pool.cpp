#include "engine/pdprt/worker_pool.h"

#include <algorithm>
#include <chrono>
#include <thread>

#include "device/opencl/opencl_error.h"

namespace kdray::pdprt {

WorkerPool::WorkerPool(std::span<const Device> devices, const Task& task, const wavefront::Capacity& capacity)
    : task_(task), capacity_(capacity) {
  std::size_t most = 0;
  for (const Device& device : devices) most = std::max(most, device.context->queues().size());
  for (std::size_t i = 0; i < most; ++i)  // in turn, as they were given out
    for (const Device& device : devices)
      if (i < device.context->queues().size()) open(device, i);
}

void WorkerPool::open(const Device& device, std::size_t number_of_device) {
  const std::size_t number = places_.size();
  Place& place = places_.emplace_back();
  place.result.number = number;
  place.result.device = device.context->info().name;
  if (task_.timeline)
    task_.timeline->name_row(static_cast<int>(number),
                             "queue " + std::to_string(number) + ": " + place.result.device);
  try {
    place.queue =
        std::make_unique<Queue>(number, device, device.context->queues()[number_of_device], task_, capacity_);
  } catch (...) {
    leave_out(number);
  }
}

// From a handler of what the queue has thrown, which is thrown on where no other queue may take over.
void WorkerPool::leave_out(std::size_t number) {
  const Error error = device::error_of_queue(std::current_exception(), "rendering");
  places_[number].result.failure = error.what();
  last_failure_ = std::make_exception_ptr(error);
}

std::size_t WorkerPool::n_working() const {
  return static_cast<std::size_t>(std::count_if(places_.begin(), places_.end(), [](const Place& place) {
    return place.queue && place.result.failure.empty();
  }));
}

void WorkerPool::require_one() const {
  if (n_working() == 0) std::rethrow_exception(last_failure_);
}

// Runs on a thread of the queue's own.
void WorkerPool::run(std::size_t number, Tiles& tiles, const Work& work) {
  Place& place = places_[number];
  try {
    place.queue->serve(tiles, work, shared_);
  } catch (...) {
    const std::lock_guard lock(mutex_);
    try {
      leave_out(number);
      place.queue->withdraw(shared_);
      place.result.tiles_lost = tiles.give_back(number);
      if (n_working() == 0) tiles.leave();
    } catch (...) {
      fault_ = std::current_exception();
      tiles.leave();
    }
  }
  const std::lock_guard lock(mutex_);
  --n_running_;
  changed_.notify_one();
}

// Waits until every queue's thread has ended.
void WorkerPool::wait(Tiles& tiles, double step, const std::function<void()>& beside) {
  std::unique_lock lock(mutex_);
  while (n_running_ > 0) {
    changed_.wait_for(lock, std::chrono::duration<double>(step));
    lock.unlock();
    try {
      beside();
    } catch (...) {
      tiles.leave();
      throw;
    }
    lock.lock();
  }
}

void WorkerPool::render(Tiles& tiles, const Work& work, double step, const std::function<void()>& beside) {
  n_running_ = n_working();
  {
    std::vector<std::jthread> threads;
    for (std::size_t i = 0; i < places_.size(); ++i) {
      if (places_[i].result.failure.empty())
        threads.emplace_back([this, i, &tiles, &work] { run(i, tiles, work); });
      else
        tiles.give_back(i);
    }
    wait(tiles, step, beside);
  }
  if (fault_) std::rethrow_exception(fault_);
  require_one();
}

void WorkerPool::collect(Result& result) {
  for (Place& place : places_) {
    if (place.queue) {
      const wavefront::Wavefront& wavefront = place.queue->wavefront();
      result.counters.add(wavefront.counters());
      for (const auto& [stage, time] : wavefront.stage_seconds()) result.stage_seconds[stage] += time;
      place.result.busy_seconds = wavefront.busy_seconds();
      place.result.rays = wavefront.counters().total();
      place.result.tiles = place.queue->tiles();
      place.result.device_bytes = wavefront.device_bytes();
      result.tile_cost.add(place.queue->tile_cost());
    }
    result.queues.push_back(std::move(place.result));
  }
}

}  // namespace kdray::pdprt
