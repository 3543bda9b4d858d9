// What    Those who measure ranks together: threads of this process, or the processes that mpirun has
//         started. All do the same steps; the first so many of them make up a group, which are the ranks of
//         one measurement.
// Shape   A group's messages carry its number: what others have begun to send in one that this member is not
//         at yet is kept until it is.
// Errors  A member that fails says why in a line and ends all.
// Threads A member's calls come from its own thread.
#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "cluster/transport/transport.h"

namespace kdray::bench {

class Team {
 public:
  explicit Team(std::unique_ptr<transport::Transport> transport);

  int number() const { return transport_->rank(); }
  int size() const { return transport_->ranks(); }
  bool leads() const { return number() == 0; }

  // Waits until all are here.
  void meet();

  // The transport of this member's rank in a group of the first n, where what comes is held back for
  // `delay` seconds; null: it is none of them. All members call it; it may not outlive the team.
  std::unique_ptr<transport::Transport> group(int n, double delay = 0);

  // What each member has given, to member 0; nothing to the others.
  std::vector<double> gather(double own);

  // All members call it last.
  void leave();

  // From a handler of what a member's work has thrown.
  [[noreturn]] void abort(int exit_code);

 private:
  friend class GroupMember;
  void look();  // moves on what is on its way
  std::optional<transport::Message> next_of_group(std::uint32_t group);
  transport::Message wait_for(transport::Tag tag);

  std::unique_ptr<transport::Transport> transport_;
  std::deque<transport::Message> of_team_, of_groups_;
  std::uint32_t n_groups_ = 0;
};

// Runs `work` as every member: this process' over `transport` (mpirun's), or without one as `n` threads.
void run_team(std::unique_ptr<transport::Transport> transport, int n, const std::function<void(Team&)>& work);

}  // namespace kdray::bench
