// What    The side of every rank but 0 of a list of tiles that ranks share: gets tiles before they are
//         wanted, and sends their sums home as they are done. Where this rank serves others
//         (tile_hierarchy.h), it passes on to them what they want, and home what they have done.
// Shape   next_list(), then step() until the queues have rendered what there is of it and is_done(), then
//         finish_list(); until there is no list any more. What the queues' threads hand to take() is sent
//         by step(), in messages of some hundred KiB.
// Errors  ErrorCode::internal: messages that make no sense. transport::Ended.
// Threads One calls all but take(), which is for any.
#pragma once

#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "engine/pdprt/rank_messages.h"
#include "engine/pdprt/tile_hierarchy.h"
#include "engine/pdprt/tile_server.h"
#include "engine/pdprt/tiles.h"

namespace kdray::pdprt {

class TileClient {
 public:
  TileClient(transport::Ranks& ranks, const SharedFrame& frame, const TileHierarchy& hierarchy);

  struct List {
    Begin head;
    std::vector<layout::u32> samples;
  };
  // Whether the next list has been begun; is_finished(): there will be none.
  std::optional<List> next_list();
  bool is_finished() const { return is_finished_; }

  // `n_rendered`: of the list, so far.
  void step(Tiles& tiles, std::size_t n_rendered);
  bool is_done() const { return !below_ || below_->is_done(); }  // with this rank's own clients
  void finish_list();

  // Sends home what this rank's queues have rendered, or its clients.
  void take(const wavefront::PlacedFilms& films, std::span<const layout::u32> entries);

 private:
  std::optional<transport::Message> next_message();
  std::uint32_t number_of(const transport::Message& message) const;
  void take(const transport::Message& message, Tiles& tiles);
  void take_grant(const transport::Message& message, Tiles& tiles);
  void ask(const Tiles& tiles, std::size_t n_rendered);
  checkpoint::Rectangle places_of(layout::u32 entry) const;
  void send_pieces(std::size_t least_bytes);

  transport::Ranks& ranks_;
  SharedFrame frame_;
  int server_;
  std::optional<TileServer> below_;  // where this rank serves others
  Begin list_;
  std::optional<transport::Message> next_;  // has come while a list was in work
  std::size_t n_granted_ = 0;
  bool is_over_ = false, is_finished_ = false;
  PrefetchPolicy prefetch_;
  std::mutex mutex_;
  std::string records_;  // that are to be sent
};

}  // namespace kdray::pdprt
