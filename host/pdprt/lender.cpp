#include "pdprt/lender.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "ledger/record.h"

namespace kdray::pdprt {

namespace {

constexpr std::size_t kPartsPerRank = 4;  // of its share of what is left, as Tiles has it for queues

}  // namespace

Lender::Lender(transport::Ranks& ranks, const SharedFrame& frame)
    : ranks_(ranks), frame_(frame), rendered_(static_cast<std::size_t>(ranks.size())) {}

void Lender::begin(Begin head, std::vector<layout::u32> entries, std::span<const layout::u32> samples,
                   Take take) {
  head.list = list_ = ranks_.next_number();
  head.n_entries = entries.size();
  of_runs_ = head.of_runs != 0;
  bag_ = std::move(entries);
  next_ = n_lent_ = 0;
  borrower_.clear();
  std::ranges::fill(rendered_, 0);
  own_appetite_ = {};
  take_ = std::move(take);
  ranks_.send_to_others(kBegin, to_bytes(head, samples));
}

// At the end a rank that renders many tiles in a message's time gets up to half of its share.
std::span<const layout::u32> Lender::lend(std::size_t least) {
  const std::size_t left = bag_.size() - next_, ranks = static_cast<std::size_t>(ranks_.size());
  const std::size_t part = left / (kPartsPerRank * ranks), most = (left + 2 * ranks - 1) / (2 * ranks);
  const std::span<const layout::u32> entries =
      std::span(bag_).subspan(next_, std::max(part, std::min(least, most)));
  next_ += entries.size();
  return entries;
}

void Lender::feed(Tiles& own) {
  const double now = ranks_.now();
  const auto least = own_appetite_.ask(own.stock(), own.usual(), now);
  if (!least) return;
  const std::span<const layout::u32> entries = lend(*least);
  own_appetite_.granted(entries.size(), now);
  own.add(entries, (bag_.size() - next_) / static_cast<std::size_t>(ranks_.size()));
  if (entries.empty()) own.end();
}

void Lender::grant(int rank, const Want& want) {
  rendered_[static_cast<std::size_t>(rank)] = want.n_rendered;
  const std::span<const layout::u32> entries = lend(want.least);
  for (const layout::u32 entry : entries) borrower_[entry] = rank;
  n_lent_ += entries.size();
  ranks_.send(rank, kGrant, to_bytes(Grant{list_, entries.empty() ? 1u : 0u, bag_.size() - next_}, entries));
}

void Lender::take_pieces(const transport::Message& message) {
  std::string_view bytes = std::string_view(message.bytes).substr(sizeof(Pieces));
  while (!bytes.empty()) {
    const auto head = ledger::head_of(bytes, frame_.frame);
    if (!head || head->bytes > bytes.size()) refuse(message);
    const layout::u32 entry = head->piece.number;
    const auto borrowed = borrower_.find(entry);
    if (borrowed == borrower_.end() || borrowed->second != message.from ||
        head->piece.places != frame_.places_of(of_runs_, entry))
      refuse(message);
    // Heads and sums have whole words, and a message begins with one.
    const ledger::Sums sums(reinterpret_cast<const layout::i64*>(bytes.data() + ledger::kRecordHead),
                            head->piece.places.sums());
    if (ledger::hash_of_sums(sums) != head->content) refuse(message);
    take_(entry, sums);
    borrower_.erase(borrowed);
    --n_lent_;
    bytes.remove_prefix(head->bytes);
  }
}

void Lender::answer(const transport::Message& message) {
  switch (message.tag) {
    case kWant: {
      const Want want = head_of<Want>(message);
      // One of a list that has ended meanwhile wants nothing any more.
      if (want.list == list_) grant(message.from, want);
      break;
    }
    case kPieces:
      if (head_of<Pieces>(message).list != list_) refuse(message);
      take_pieces(message);
      break;
    default:
      refuse(message);
  }
}

void Lender::step(Tiles& own) {
  feed(own);
  while (const auto message = ranks_.next(transport::kTagsOfTiles)) answer(*message);
}

std::vector<layout::u32> Lender::close() {
  std::vector<layout::u32> left(bag_.begin() + static_cast<std::ptrdiff_t>(next_), bag_.end());
  bag_.resize(next_);
  return left;
}

std::size_t Lender::n_rendered() const {
  return std::accumulate(rendered_.begin(), rendered_.end(), std::size_t{0});
}

void Lender::finish() {
  reports_.clear();
  ranks_.send_to_others(kFinish, to_bytes(Finish{list_}));
}

bool Lender::take_reports() {
  while (auto message = ranks_.next(transport::kTagsOfTiles)) {
    if (message->tag == kWant) continue;  // was on its way when the last list ended
    if (message->tag != kReport) refuse(*message);
    reports_.push_back(std::move(*message));
  }
  return reports_.size() + 1 == static_cast<std::size_t>(ranks_.size());
}

}  // namespace kdray::pdprt
