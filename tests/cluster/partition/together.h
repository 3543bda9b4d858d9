// What    Runs what every rank does, each in a thread of its own, over the in-process transport; as
//         processes end when one of them fails.
// Shape   With a seed messages are held back for a while, so that they come in another order.
#pragma once

#include <cstdlib>
#include <functional>
#include <memory>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "cluster/transport/simulated.h"
#include "cluster/transport/together.h"

namespace kdray::test {

// Hands messages on in a random order.
class Shuffled : public transport::Transport {
 public:
  Shuffled(std::unique_ptr<transport::Transport> inner, std::uint32_t seed)
      : Transport(inner->rank(), inner->ranks()), inner_(std::move(inner)), random_(seed) {}
  std::size_t bytes_waiting() const override { return inner_->bytes_waiting(); }
  double now() const override { return inner_->now(); }
  void close() override { inner_->close(); }
  [[noreturn]] void abort(int exit_code) override {
    inner_->abort(exit_code);
    std::abort();  // it doesn't return
  }

 private:
  void post(int to, transport::Tag tag, transport::Bytes bytes) override {
    inner_->send(to, tag, std::move(bytes));
  }
  std::optional<transport::Message> take() override {
    while (auto message = inner_->poll()) held_.push_back(std::move(*message));
    if (held_.empty() || random_() % 3 == 0) return std::nullopt;
    const std::size_t i = random_() % held_.size();
    std::swap(held_[i], held_.back());
    transport::Message message = std::move(held_.back());
    held_.pop_back();
    return message;
  }

  std::unique_ptr<transport::Transport> inner_;
  std::mt19937 random_;
  std::vector<transport::Message> held_;
};

struct RankEnd {
  std::string error;  // of rank 0, or of one that has failed by itself
  int code = 0;
};

inline RankEnd run_one(transport::Ranks& ranks, const std::function<void(transport::Together&)>& run) {
  try {
    transport::Together all(ranks);
    run(all);
    // The end may overtake what rank 0 has sent before.
    constexpr transport::Tags kDone = transport::kTagsOfFrames;
    if (!ranks.leads()) ranks.send(0, kDone.first, {});
    if (!ranks.leads()) return {{}, ranks.wait_for_end(nullptr)};
    for (int n = 1; n < ranks.size(); ++n) ranks.wait(kDone);
    ranks.end(0);
    return {};
  } catch (const transport::Ended& ended) {
    ranks.leave();
    return {{}, ended.exit_code};
  } catch (const Error& error) {
    if (!ranks.leads()) return {error.what(), ranks.wait_for_end(&error)};
    ranks.end(static_cast<int>(error.code()));
    return {error.what(), static_cast<int>(error.code())};
  }
}

inline std::vector<RankEnd> run_ranks(int n, const std::function<void(transport::Together&)>& run,
                                      std::uint32_t seed = 0) {
  std::vector<std::unique_ptr<transport::Transport>> transports = transport::in_process(n);
  std::vector<RankEnd> ends(transports.size());
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < transports.size(); ++i)
    threads.emplace_back([&, i] {
      std::unique_ptr<transport::Transport> own = std::move(transports[i]);
      if (seed != 0) own = std::make_unique<Shuffled>(std::move(own), seed + static_cast<std::uint32_t>(i));
      transport::Ranks ranks(std::move(own));
      ends[i] = run_one(ranks, run);
    });
  for (std::thread& thread : threads) thread.join();
  return ends;
}

}  // namespace kdray::test
