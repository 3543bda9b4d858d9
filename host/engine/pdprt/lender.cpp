#include "engine/pdprt/lender.h"

#include <fmt/format.h>

#include <algorithm>

#include "engine/checkpoint/record.h"

namespace kdray::pdprt {

namespace {

constexpr std::size_t kPartsPerRank = 4;  // of its share of what is left, as Tiles has it for queues

}  // namespace

Lender::Lender(transport::Ranks& ranks, const SharedFrame& frame, const Bags& bags)
    : ranks_(ranks),
      frame_(frame),
      bags_(bags),
      borrowers_(bags.borrowers_of(ranks.rank())),
      n_fed_(static_cast<std::size_t>(bags.n_fed_by(ranks.rank()))) {}

void Lender::tell(transport::Tag tag, const transport::Bytes& bytes) {
  for (const int rank : borrowers_) ranks_.send(rank, tag, bytes);
}

void Lender::start(const Begin& head, std::span<const layout::u32> samples, Take take) {
  list_ = head.list;
  of_runs_ = head.of_runs != 0;
  bag_.clear();
  next_ = n_lent_ = elsewhere_ = n_rendered_ = 0;
  borrower_.clear();
  rendered_.clear();
  waiting_.clear();
  own_appetite_ = {};
  own_wants_.reset();
  take_ = std::move(take);
  tell(kBegin, to_bytes(head, samples));
}

void Lender::begin(Begin head, std::vector<layout::u32> entries, std::span<const layout::u32> samples,
                   Take take) {
  head.list = ranks_.next_number();
  head.n_entries = entries.size();
  start(head, samples, std::move(take));
  bag_ = std::move(entries);
}

void Lender::pass_on(const Begin& head, std::span<const layout::u32> samples, Take take) {
  start(head, samples, std::move(take));
  is_open_ = true;
}

void Lender::add(std::span<const layout::u32> entries, std::size_t elsewhere) {
  bag_.insert(bag_.end(), entries.begin(), entries.end());
  elsewhere_ = elsewhere;
}

void Lender::end() {
  is_open_ = false;
  elsewhere_ = 0;
}

std::size_t Lender::left_for_each() const {
  return stock() / n_fed_ + elsewhere_;
}

// At the end a rank that renders many tiles in a message's time gets up to half of its share. `n_fed`: for
// how many ranks it is.
std::span<const layout::u32> Lender::lend(std::size_t least, int n_fed) {
  const std::size_t left = (stock() + elsewhere_ * n_fed_) * static_cast<std::size_t>(n_fed);
  const std::size_t part = left / (kPartsPerRank * n_fed_), most = (left + 2 * n_fed_ - 1) / (2 * n_fed_);
  const std::size_t n = std::min(std::max(part, std::min(least, most)), stock());
  const std::span<const layout::u32> entries = std::span(bag_).subspan(next_, n);
  next_ += n;
  return entries;
}

void Lender::feed(Tiles& own) {
  const double now = ranks_.now();
  if (const auto least = own_appetite_.ask(own.stock(), own.usual(), own.usual(), now)) own_wants_ = least;
  if (!own_wants_ || !can_lend()) return;
  const std::span<const layout::u32> entries = lend(*own_wants_, 1);
  own_wants_.reset();
  own_appetite_.granted(entries.size(), now);
  own.add(entries, left_for_each());
  if (entries.empty()) own.end();
}

void Lender::grant(const Asked& asked) {
  const std::span<const layout::u32> entries = lend(asked.least, bags_.n_fed_by(asked.rank));
  for (const layout::u32 entry : entries) borrower_[entry] = asked.rank;
  n_lent_ += entries.size();
  ranks_.send(asked.rank, kGrant,
              to_bytes(Grant{list_, entries.empty() ? 1u : 0u, left_for_each()}, entries));
}

void Lender::take_want(int rank, const Want& want) {
  if (want.list != list_) return;  // of a list that has ended meanwhile: it wants nothing any more
  std::size_t& rendered = rendered_[rank];
  n_rendered_ += want.n_rendered - rendered;
  rendered = want.n_rendered;
  waiting_.push_back({rank, want.least});
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
  if (!bags_.lends_to(ranks_.rank(), message.from)) refuse(message);
  if (message.tag == kWant) return take_want(message.from, head_of<Want>(message));
  if (message.tag != kPieces || head_of<Pieces>(message).list != list_) refuse(message);
  take_pieces(message);
}

void Lender::step(Tiles& own) {
  feed(own);
  if (ranks_.leads())
    while (const auto message = ranks_.next(transport::kTagsOfTiles)) answer(*message);
  for (; !waiting_.empty() && can_lend(); waiting_.pop_front()) grant(waiting_.front());
}

std::vector<layout::u32> Lender::close() {
  std::vector<layout::u32> left(bag_.begin() + static_cast<std::ptrdiff_t>(next_), bag_.end());
  bag_.resize(next_);
  return left;
}

void Lender::finish() {
  reports_.clear();
  tell(kFinish, to_bytes(Finish{ranks_.number()}));
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
