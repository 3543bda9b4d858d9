#include "pdprt/borrower.h"

#include <utility>

#include "ledger/record.h"

namespace kdray::pdprt {

namespace {

constexpr std::size_t kMessageBytes = std::size_t{256} << 10;

// Whether a message about a list is of one that is over.
bool is_old(std::uint32_t list, std::uint32_t now) {
  return static_cast<std::int32_t>(list - now) <= 0;
}

// Every message of rank 0's begins with it.
std::uint32_t number_of(const transport::Message& message) {
  return head_of<Finish>(message).list;
}

}  // namespace

// A list that has ended before this rank heard of it may come late.
std::optional<Borrower::List> Borrower::next_list() {
  const auto message = next_ ? std::exchange(next_, std::nullopt) : ranks_.next(transport::kTagsOfTiles);
  if (!message) return std::nullopt;
  if (message->tag != kGrant && message->tag != kBegin && message->tag != kFinish) refuse(*message);
  const std::uint32_t list = number_of(*message);
  if (message->tag == kFinish) {
    is_finished_ = true;
    ranks_.reach(list);
    return std::nullopt;
  }
  if (is_old(list, ranks_.number())) return std::nullopt;
  if (message->tag == kGrant) refuse(*message);
  ranks_.reach(list);
  list_ = head_of<Begin>(*message);
  n_granted_ = 0;
  is_over_ = false;
  appetite_ = {};
  return List{list_, words_behind<Begin>(*message)};
}

void Borrower::take_grant(const transport::Message& message, Tiles& tiles) {
  const Grant grant = head_of<Grant>(message);
  if (grant.list != list_.list) {
    if (!is_old(grant.list, list_.list)) refuse(message);
    return;
  }
  const std::vector<layout::u32> entries = words_behind<Grant>(message);
  n_granted_ += entries.size();
  if (n_granted_ > list_.n_entries) refuse(message);
  for (const layout::u32 entry : entries)
    if (frame_.places_of(list_.of_runs != 0, entry).width == 0) refuse(message);
  appetite_.granted(entries.size(), ranks_.now());
  tiles.add(entries, grant.n_left / static_cast<std::size_t>(ranks_.size()));
  is_over_ = grant.is_over != 0;
}

// Rank 0 goes on when it has all sums of this list: whatever this rank still asks for, there is none. Of
// several lists that have been begun since, the last counts.
void Borrower::take(const transport::Message& message, Tiles& tiles) {
  if (message.tag == kGrant) return take_grant(message, tiles);
  if (message.tag != kBegin && message.tag != kFinish) refuse(message);
  const std::uint32_t list = number_of(message);
  if (message.tag == kBegin && is_old(list, next_ ? number_of(*next_) : list_.list)) return;
  next_ = message;
  is_over_ = true;
}

void Borrower::step(Tiles& tiles, std::size_t n_rendered) {
  while (const auto message = ranks_.next(transport::kTagsOfTiles)) take(*message, tiles);
  send_pieces(kMessageBytes);
  if (is_over_) return tiles.end();
  if (const auto least = appetite_.ask(tiles.stock(), tiles.usual(), ranks_.now()))
    ranks_.send(0, kWant,
                to_bytes(Want{list_.list, static_cast<std::uint32_t>(std::min<std::size_t>(*least, 1u << 20)),
                              static_cast<std::uint32_t>(n_rendered), 0}));
}

void Borrower::append(const wavefront::FilmSums& film, layout::u32 entry, std::string& records) const {
  const bool of_runs = list_.of_runs != 0;
  const ledger::Rectangle r = frame_.places_of(of_runs, entry);
  std::vector<layout::i64> sums;
  sums.reserve(r.sums());
  for (std::size_t row = 0; row < r.height; ++row) {
    const std::size_t place = of_runs ? r.x : (r.y + row) * frame_.width + r.x;
    const ledger::Sums from = film.sums.subspan(3 * (place - film.first), std::size_t{3} * r.width);
    sums.insert(sums.end(), from.begin(), from.end());
  }
  ledger::append_record(records, frame_.frame, {of_runs ? 1u : 0u, entry, r}, sums,
                        ledger::hash_of_sums(sums));
}

void Borrower::deliver(const wavefront::FilmSums& film, std::span<const layout::u32> entries) {
  std::string records;
  for (const layout::u32 entry : entries) append(film, entry, records);
  const std::lock_guard lock(mutex_);
  records_ += records;
}

// Whole records in each message.
void Borrower::send_pieces(std::size_t least_bytes) {
  std::string records;
  {
    const std::lock_guard lock(mutex_);
    if (records_.size() < std::max<std::size_t>(least_bytes, 1)) return;
    records.swap(records_);
  }
  for (std::size_t at = 0; at < records.size();) {
    std::size_t end = at;
    while (end < records.size() && end - at < kMessageBytes)
      end += ledger::head_of(std::string_view(records).substr(end), frame_.frame)->bytes;
    ranks_.send(0, kPieces, to_bytes(Pieces{list_.list, 0}).append(records, at, end - at));
    at = end;
  }
}

void Borrower::finish_list() {
  send_pieces(1);
}

}  // namespace kdray::pdprt
