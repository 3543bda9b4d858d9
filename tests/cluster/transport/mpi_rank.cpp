// One rank of MpiTest: argument 1 is how many ranks there should be, argument 2 what to do.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string_view>
#include <thread>

#include "cluster/transport/exercise.h"
#include "cluster/transport/mpi.h"

int main(int argc, char** argv) {
  using namespace kdray;
  if (argc < 3) return 2;
  try {
    const int expected = std::atoi(argv[1]);
    if (transport::launched().ranks != expected)
      throw std::runtime_error("the launcher tells another number");
    const auto mpi = transport::open_mpi(expected);
    if (mpi->rank() != transport::launched().rank)
      throw std::runtime_error("the launcher tells another rank");
    if (std::string_view(argv[2]) == "abort") {
      if (mpi->rank() == 1) mpi->abort(7);
      std::this_thread::sleep_for(std::chrono::seconds(30));
    }
    // By another thread than the one that has opened it, as kdray may.
    std::thread([&] {
      for (test::Exercise exercise(*mpi, 40); exercise.step() || mpi->bytes_waiting() > 0;)
        std::this_thread::sleep_for(std::chrono::microseconds(200));
    }).join();
    if (mpi->counters().sent != mpi->counters().received) throw std::runtime_error("the counters differ");
    mpi->close();
    std::printf("rank %d: well\n", mpi->rank());
    return 0;
  } catch (const std::exception& error) {
    std::printf("failed: %s\n", error.what());
    return 1;
  }
}
