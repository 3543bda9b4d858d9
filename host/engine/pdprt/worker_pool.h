// What    The queues of this process, at work on a list of tiles: a thread for each.
// Errors  A queue whose device fails, or has too little memory, is left alone from then on: the others render
//         the tiles that it has not delivered. The error of the last queue, when all fail. Any other error
//         ends the list (device/opencl/opencl_error.h). ODPRT has odprt/executor.h for this.
#pragma once

#include <condition_variable>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <vector>

#include "engine/pdprt/queue.h"

namespace kdray::pdprt {

class WorkerPool {
 public:
  WorkerPool(std::span<const Device> devices, const Task& task, const wavefront::Capacity& capacity);

  std::size_t size() const { return places_.size(); }
  void require_one() const;  // throws where no queue is left

  // Renders until the tiles are over. `beside` is called by the calling thread meanwhile, every `step`
  // seconds or so.
  void render(Tiles& tiles, const Work& work, double step, const std::function<void()>& beside);

  Shared& shared() { return shared_; }
  const Shared& shared() const { return shared_; }

  // Adds what the queues have done to the result.
  void collect(Result& result);

 private:
  struct Place {  // of a queue, whether it works or not
    std::unique_ptr<Queue> queue;
    QueueResult result;
  };

  void open(const Device& device, std::size_t number_of_device);
  void run(std::size_t number, Tiles& tiles, const Work& work);
  void leave_out(std::size_t number);
  void wait(Tiles& tiles, double step, const std::function<void()>& beside);
  std::size_t n_working() const;

  const Task& task_;
  wavefront::Capacity capacity_;
  Shared shared_;
  std::vector<Place> places_;
  std::exception_ptr last_failure_;  // of a queue
  std::mutex mutex_;                 // of the following
  std::condition_variable changed_;
  std::size_t n_running_ = 0;
  std::exception_ptr fault_;  // for which no other queue may take over: ends the frame
};

}  // namespace kdray::pdprt
