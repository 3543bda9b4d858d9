// What    The side of a list of tiles that serves them: the bag, who has what of it, and what has come back.
//         It is rank 0's, and that of ranks that pass on what rank 0 has assigned to them (tile_hierarchy.h).
// Shape   begin() or pass_on() tells the clients; then step() answers them, and feeds this rank's
//         own queues from the same bag, until is_done(): every tile's sums are where they belong. A rank gets
//         a part of what is left, so that all come to their end together, but no less than it renders while a
//         message is on its way. A bag that is filled from another one is open until end(): who asks while
//         there is nothing in it is answered when there is.
// Errors  ErrorCode::internal: records that were damaged on their way, that nobody asked the rank for, or
//         that came twice.
#pragma once

#include <deque>
#include <optional>
#include <unordered_map>
#include <vector>

#include "engine/frame/driver.h"
#include "engine/pdprt/rank_messages.h"
#include "engine/pdprt/tile_hierarchy.h"
#include "engine/pdprt/tiles.h"

namespace kdray::pdprt {

class TileServer {
 public:
  TileServer(transport::Ranks& ranks, const SharedFrame& frame, const TileHierarchy& hierarchy);

  // `samples` of the list's runs. `sink` gets the sums of a record. Rank 0's, which numbers the list.
  void begin(Begin head, std::vector<layout::u32> entries, std::span<const layout::u32> samples,
             frame::Sink sink);

  // The others': a list that has been begun, with nothing of it yet. `elsewhere`: how many tiles there are
  // that nobody has, for each rank.
  void pass_on(const Begin& head, std::span<const layout::u32> samples, frame::Sink sink);
  void add(std::span<const layout::u32> entries, std::size_t elsewhere);
  void end();
  std::size_t stock() const { return bag_.size() - next_; }
  std::size_t n_assigned() const { return n_assigned_; }
  std::size_t n_clients() const { return clients_.size(); }

  void step(Tiles& own);
  // A message of a client; step() takes them all where a rank is nobody's client itself.
  void answer(const transport::Message& message);
  // The time is over: what nobody has is not assigned any more.
  std::vector<layout::u32> close();
  bool is_done() const { return n_assigned_ == 0 && next_ == bag_.size() && !is_open_; }

  // By the clients, as far as they have told: of the present list.
  std::size_t n_rendered() const { return n_rendered_; }

  // After the last list.
  void finish();
  // Rank 0's, from then on: takes what the others say that they have done. False: not all have.
  bool take_reports();
  const std::vector<transport::Message>& reports() const { return reports_; }

 private:
  struct Request {
    int rank;
    std::size_t least;
  };

  void start(const Begin& head, std::span<const layout::u32> samples, frame::Sink sink);
  void tell(transport::Tag tag, const transport::Bytes& bytes);
  bool can_assign() const { return stock() > 0 || !is_open_; }
  std::span<const layout::u32> assign(std::size_t least, int n_served);
  std::size_t left_for_each() const;
  void feed(Tiles& own);
  void grant(const Request& request);
  void take_want(int rank, const Want& want);
  void take_records(const transport::Message& message);

  transport::Ranks& ranks_;
  SharedFrame frame_;
  TileHierarchy hierarchy_;
  std::vector<int> clients_;
  std::size_t n_served_;  // ranks, this one among them
  std::uint32_t list_ = 0;
  bool of_runs_ = false, is_open_ = false;
  std::vector<layout::u32> bag_;
  std::size_t next_ = 0, n_assigned_ = 0, elsewhere_ = 0, n_rendered_ = 0;
  std::unordered_map<layout::u32, int> assigned_to_;  // of entries that others have
  std::unordered_map<int, std::size_t> rendered_;     // by rank
  std::deque<Request> waiting_;                       // for something to be assigned
  PrefetchPolicy own_prefetch_;
  std::optional<std::size_t> own_wants_;
  frame::Sink sink_;  // of the list
  std::vector<transport::Message> reports_;
};

}  // namespace kdray::pdprt
