// What    Rank 0's side of a list of tiles that ranks share: the bag, who has what of it, and what has come
//         back.
// Shape   begin() tells the others; then step() answers them, and feeds this rank's own queues from the same
//         bag, until is_done(): every tile's sums are where they belong. A rank gets a part of what is left,
//         so that all come to their end together, but no less than it renders while a message is on its way.
// Errors  ErrorCode::internal: pieces that were damaged on their way, that nobody asked the rank for, or that
//         came twice.
#pragma once

#include <functional>
#include <unordered_map>
#include <vector>

#include "pdprt/appetite.h"
#include "pdprt/rank_messages.h"
#include "pdprt/tiles.h"

namespace kdray::pdprt {

class Lender {
 public:
  Lender(transport::Ranks& ranks, const SharedFrame& frame);

  using Take = std::function<void(layout::u32 entry, ledger::Sums sums)>;
  // `samples` of the list's runs. `take` puts the sums of a piece where they belong.
  void begin(Begin head, std::vector<layout::u32> entries, std::span<const layout::u32> samples, Take take);

  void step(Tiles& own);
  // The time is over: what nobody has is not lent any more.
  std::vector<layout::u32> close();
  bool is_done() const { return n_lent_ == 0 && next_ == bag_.size(); }

  // By the others, as far as they have told: of the present list.
  std::size_t n_rendered() const;

  // After the last list: asks the others what they have done, and takes what has come of it. False: not all
  // has.
  void finish();
  bool take_reports();
  const std::vector<transport::Message>& reports() const { return reports_; }

 private:
  std::span<const layout::u32> lend(std::size_t least);
  void feed(Tiles& own);
  void answer(const transport::Message& message);
  void grant(int rank, const Want& want);
  void take_pieces(const transport::Message& message);

  transport::Ranks& ranks_;
  SharedFrame frame_;
  std::uint32_t list_ = 0;
  bool of_runs_ = false;
  std::vector<layout::u32> bag_;
  std::size_t next_ = 0, n_lent_ = 0;
  std::unordered_map<layout::u32, int> borrower_;  // of entries that others have
  std::vector<std::size_t> rendered_;              // by rank
  Appetite own_appetite_;
  Take take_;
  std::vector<transport::Message> reports_;
};

}  // namespace kdray::pdprt
