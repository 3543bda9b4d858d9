// What    The ranks of a run: a transport, with what all protocols over it have in common. Rank 0 leads.
// Shape   Each protocol has tags of its own; a message is kept until its tag is asked for, since they
//         come in any order. A rank that fails tells rank 0, which then says why and ends all; a rank that is
//         told to end finds out when it next looks for messages.
// Errors  On rank 0, kdray::Error: why another rank has failed, with its number. On the others, Ended: rank 0
//         has ended the run.
// Threads One, the one that renders.
#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <string_view>

#include "base/error.h"
#include "cluster/transport/transport.h"

namespace kdray::transport {

// Tags of one protocol. Its messages are defined for ranks in ranks.cpp, cores mpi.cpp, scenes
// apps/cli/render_frame.cpp, frames api/job.cpp, tiles pdprt/rank_messages.h, shares together.cpp, and in
// engine/odprt for lists, divisions and joining in rank_table.h, rays rank_exchange.cpp.
struct Tags {
  Tag first, last;
  bool hold(Tag tag) const { return first <= tag && tag <= last; }
};
inline constexpr Tags kTagsOfRanks{0, 15}, kTagsOfCores{16, 17}, kTagsOfScenes{24, 24}, kTagsOfFrames{32, 47},
    kTagsOfTiles{48, 63}, kTagsOfShares{64, 79}, kTagsOfLists{80, 86}, kTagsOfDivisions{87, 87},
    kTagsOfJoining{88, 95}, kTagsOfRays{96, 111};

// Thrown where rank 0 has ended the run, which is no error of this rank's; holds the code to exit with.
struct Ended {
  int exit_code;
};

class Ranks {
 public:
  explicit Ranks(std::unique_ptr<Transport> transport) : transport_(std::move(transport)) {}

  int rank() const { return transport_->rank(); }
  int size() const { return transport_->ranks(); }
  bool leads() const { return rank() == 0; }

  void send(int to, Tag tag, Bytes bytes) { transport_->send(to, tag, std::move(bytes)); }
  void send_to_others(Tag tag, const Bytes& bytes);

  // Returns a message of these tags, if one has come; wait() waits for it.
  std::optional<Message> next(Tags tags);
  Message wait(Tags tags);

  // A count that goes up over the whole run, for what a protocol has to tell apart. Rank 0 counts; the others
  // reach the numbers that they hear of.
  std::uint32_t next_number() { return ++number_; }
  std::uint32_t number() const { return number_; }
  void reach(std::uint32_t number) { number_ = number; }

  double now() const { return transport_->now(); }
  const Counters& counters() const { return transport_->counters(); }

  // On rank 0: ends the run, when all is done or `exit_code` says that it failed, and tells the others.
  void end(int exit_code);
  // On the others: waits for rank 0 to end the run, and returns the code to exit with. `failure` is why this
  // rank can't go on; null: it has done its part.
  int wait_for_end(const Error* failure);
  // On the others: leaves the run, after Ended was caught.
  void leave();

 private:
  void look();
  void mind(const Message& message);

  std::unique_ptr<Transport> transport_;
  std::deque<Message> kept_;
  int n_gone_ = 0;
  std::uint32_t number_ = 0;
  bool is_ending_ = false;
};

}  // namespace kdray::transport
