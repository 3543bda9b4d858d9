// What    Ranks that are threads of the test, over any transports.
#pragma once

#include <barrier>
#include <cstddef>
#include <exception>
#include <functional>
#include <memory>
#include <thread>
#include <utility>
#include <vector>

#include "cluster/transport/ranks.h"
#include "kdray/error.h"

namespace kdray::test {

// Runs `body` as each rank. What ranks throw is thrown, rank 0's first. `ready`: called before all begin at
// the same time, else rank 0 may have done everything before others are there.
inline void run_ranks(
    std::vector<std::unique_ptr<transport::Transport>> transports,
    const std::function<void(transport::Ranks&, const std::function<void()>& ready)>& body) {
  const std::size_t n = transports.size();
  std::vector<std::exception_ptr> thrown(n);
  std::barrier all_ready(static_cast<std::ptrdiff_t>(n));
  std::vector<std::jthread> threads;
  for (std::size_t rank = 0; rank < n; ++rank)
    threads.emplace_back([&, rank] {
      transport::Ranks ranks(std::move(transports[rank]));
      try {
        body(ranks, [&] { all_ready.arrive_and_wait(); });
        rank == 0 ? ranks.end(0) : void(ranks.wait_for_end(nullptr));
      } catch (const Error& error) {
        thrown[rank] = std::current_exception();
        rank == 0 ? ranks.end(1) : void(ranks.wait_for_end(&error));
      } catch (const transport::Ended&) {
        ranks.leave();
      }
    });
  threads.clear();
  for (const std::exception_ptr& error : thrown)
    if (error) std::rethrow_exception(error);
}

}  // namespace kdray::test
