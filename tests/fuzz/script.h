// What    A transport whose messages are an input's: what a rank does about anything that others may send it.
// Shape   Each message of the input is a byte of who has sent it, a byte of its tag, a block (Input::block)
//         of its bytes; or, where ranks go in steps (transport::Together), a block alone, which comes from
//         each of the others in turn. Behind the last one the run is over, as rank 0 ends it or as another
//         rank fails.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>

#include "cluster/transport/ranks.h"
#include "fuzz/target.h"

namespace kdray::fuzz {

class Script final : public transport::Transport {
 public:
  using Amend = std::function<void(transport::Message&)>;
  Script(int rank, int ranks, std::string_view input, transport::Tags tags, Amend amend)
      : Transport(rank, ranks), input_(input), tags_(tags), amend_(std::move(amend)) {}

  std::size_t bytes_waiting() const override { return 0; }
  double now() const override { return static_cast<double>(n_looks_) * 1e-3; }
  [[noreturn]] void abort(int) override { fail("a rank ends all"); }

 private:
  void post(int, transport::Tag, transport::Bytes) override {}

  // One at a time, and nothing between two: whoever waits looks at the first before the next comes.
  std::optional<transport::Message> take() override {
    if (std::exchange(is_next_, !is_next_)) return std::nullopt;
    ++n_looks_;
    constexpr transport::Tag kFailed = 0, kEnd = 1;
    if (input_.is_at_end() && ++n_in_vain_ > n_looks_in_vain())
      return transport::Message{rank() == 0 ? 1 : 0, rank() == 0 ? kFailed : kEnd,
                                std::string("\1\0\0\0.", 5)};
    if (input_.is_at_end()) return std::nullopt;
    return tags_.first == transport::kTagsOfShares.first ? next_of_step() : next_message();
  }

  // Ranks that share tiles do something between two looks; the others wait, a millisecond each time.
  unsigned n_looks_in_vain() const { return tags_.first == transport::kTagsOfTiles.first ? 50 : 0; }

  transport::Message next_message() {
    transport::Message message;
    message.from = input_.take<std::uint8_t>() % ranks();
    const auto n_tags = static_cast<std::uint8_t>(tags_.last - tags_.first + 1);
    message.tag = static_cast<transport::Tag>(tags_.first + input_.take<std::uint8_t>() % n_tags);
    message.bytes = input_.block();
    if (amend_) amend_(message);
    return message;
  }

  // A step's messages end with its number.
  transport::Message next_of_step() {
    const auto n_others = static_cast<unsigned>(ranks() - 1), n = n_of_steps_++;
    const std::uint32_t step = n / n_others + 1;
    transport::Message message;
    message.from = (rank() + 1 + static_cast<int>(n % n_others)) % ranks();
    message.tag = tags_.first;
    message.bytes = input_.block();
    if (amend_) amend_(message);
    message.bytes.append(reinterpret_cast<const char*>(&step), sizeof step);
    return message;
  }

  Input input_;
  transport::Tags tags_;
  Amend amend_;
  bool is_next_ = false;
  unsigned n_looks_ = 0, n_in_vain_ = 0, n_of_steps_ = 0;
};

// Returns whether `act`, of a rank among several, has come to its end with these messages; false where they
// are refused or it waits for more. `amend` makes right what no fuzzer guesses.
template <class Act>
bool plays(int rank, int ranks, std::string_view messages, transport::Tags tags, const Act& act,
           Script::Amend amend = {}) {
  transport::Ranks all(std::make_unique<Script>(rank, ranks, messages, tags, std::move(amend)));
  try {
    act(all);
    return true;
  } catch (const transport::Ended&) {
    return false;
  } catch (const Error& e) {
    // Nonsense is refused as internal; ErrorCode::input is the end of the script, and what is too much for a
    // rank.
    if (e.code() != ErrorCode::internal && e.code() != ErrorCode::input)
      fail(std::string("refused as: ") + e.what());
    return false;
  }
}

}  // namespace kdray::fuzz
