#include "engine/pdprt/tile_client.h"

#include <utility>

#include "engine/checkpoint/record.h"

namespace kdray::pdprt {

namespace {

constexpr std::size_t kMessageBytes = std::size_t{256} << 10;

// Whether a message about a list is of one that is over.
bool is_old(std::uint32_t list, std::uint32_t now) {
  return static_cast<std::int32_t>(list - now) <= 0;
}

}  // namespace

TileClient::TileClient(transport::Ranks& ranks, const SharedFrame& frame, const TileHierarchy& hierarchy)
    : ranks_(ranks), frame_(frame), server_(hierarchy.server_of(ranks.rank())) {
  if (hierarchy.n_served_by(ranks.rank()) > 1) below_.emplace(ranks, frame, hierarchy);
}

// Every message of a server begins with it.
std::uint32_t TileClient::number_of(const transport::Message& message) const {
  const bool is_servers = message.tag == kGrant || message.tag == kBegin || message.tag == kFinish;
  if (!is_servers || message.from != server_) refuse(message);
  return head_of<Finish>(message).list;
}

// Between two lists: a client of this rank may still want something of the last one.
std::optional<transport::Message> TileClient::next_message() {
  if (next_) return std::exchange(next_, std::nullopt);
  auto message = ranks_.next(transport::kTagsOfTiles);
  while (message && below_ && message->tag == kWant) message = ranks_.next(transport::kTagsOfTiles);
  return message;
}

// A list that has ended before this rank heard of it may come late.
std::optional<TileClient::List> TileClient::next_list() {
  const auto message = next_message();
  if (!message) return std::nullopt;
  const std::uint32_t number = number_of(*message);
  if (message->tag == kFinish) {
    is_finished_ = true;
    ranks_.reach(number);
    if (below_) below_->finish();
    return std::nullopt;
  }
  if (is_old(number, ranks_.number())) return std::nullopt;
  if (message->tag == kGrant) refuse(*message);
  ranks_.reach(number);
  list_ = head_of<Begin>(*message);
  n_granted_ = 0;
  is_over_ = false;
  prefetch_ = {};
  List list{list_, words_behind<Begin>(*message)};
  if (below_)
    below_->pass_on(list.head, list.samples,
                    [this](const auto& films, auto entries) { take(films, entries); });
  return list;
}

void TileClient::take_grant(const transport::Message& message, Tiles& tiles) {
  const Grant grant = head_of<Grant>(message);
  const std::vector<layout::u32> entries = words_behind<Grant>(message);
  n_granted_ += entries.size();
  if (n_granted_ > list_.n_entries) refuse(message);
  for (const layout::u32 entry : entries)
    if (places_of(entry).width == 0) refuse(message);
  prefetch_.granted(entries.size(), ranks_.now());
  below_ ? below_->add(entries, grant.n_left) : tiles.add(entries, grant.n_left);
  is_over_ = grant.is_over != 0;
}

// The server goes on when it has all sums of this list: whatever this rank still asks for, there is none. Of
// several lists that have been begun since, the last counts.
void TileClient::take(const transport::Message& message, Tiles& tiles) {
  if (below_ && (message.tag == kWant || message.tag == kRecords)) return below_->answer(message);
  const std::uint32_t number = number_of(message);
  if (message.tag == kGrant && number == list_.list) return take_grant(message, tiles);
  if (message.tag == kGrant && !is_old(number, list_.list)) refuse(message);
  if (message.tag == kGrant) return;
  if (message.tag == kBegin && is_old(number, next_ ? number_of(*next_) : list_.list)) return;
  next_ = message;
  is_over_ = true;
}

void TileClient::step(Tiles& tiles, std::size_t n_rendered) {
  while (const auto message = ranks_.next(transport::kTagsOfTiles)) take(*message, tiles);
  if (is_over_) below_ ? below_->end() : tiles.end();
  if (below_) below_->step(tiles);
  send_pieces(kMessageBytes);
  if (!is_over_) ask(tiles, n_rendered);
}

void TileClient::ask(const Tiles& tiles, std::size_t n_rendered) {
  std::size_t stock = tiles.stock(), usual = tiles.usual();
  std::size_t in_work = usual;
  if (below_) {
    stock += below_->stock();
    usual += below_->n_clients();
    in_work += below_->n_assigned();
    n_rendered += below_->n_rendered();
  }
  const auto least = prefetch_.ask(stock, usual, in_work, ranks_.now());
  if (!least) return;
  ranks_.send(server_, kWant,
              to_bytes(Want{list_.list, static_cast<std::uint32_t>(std::min<std::size_t>(*least, 1u << 20)),
                            static_cast<std::uint32_t>(n_rendered), 0}));
}

checkpoint::Rectangle TileClient::places_of(layout::u32 entry) const {
  return frame_.places_of(list_.of_runs != 0, entry);
}

void TileClient::take(const wavefront::PlacedFilms& films, std::span<const layout::u32> entries) {
  std::string records;
  std::vector<layout::i64> sums;
  for (const layout::u32 entry : entries) {
    const checkpoint::Rectangle r = places_of(entry);
    sums.clear();
    for (std::size_t y = r.y; y < r.y + r.height; ++y) {
      const checkpoint::Sums row = films.films.front().subspan(films.at(r.x, y), std::size_t{3} * r.width);
      sums.insert(sums.end(), row.begin(), row.end());
    }
    checkpoint::append_record(records, frame_.frame, {list_.of_runs, entry, r}, sums,
                              checkpoint::hash_of_sums(sums));
  }
  const std::lock_guard lock(mutex_);
  records_ += records;
}

// Whole records in each message.
void TileClient::send_pieces(std::size_t least_bytes) {
  std::string records;
  {
    const std::lock_guard lock(mutex_);
    if (records_.size() < std::max<std::size_t>(least_bytes, 1)) return;
    records.swap(records_);
  }
  for (std::size_t at = 0; at < records.size();) {
    std::size_t end = at;
    while (end < records.size() && end - at < kMessageBytes)
      end += checkpoint::head_of(std::string_view(records).substr(end), frame_.frame)->bytes;
    ranks_.send(server_, kRecords, to_bytes(Records{list_.list, 0}).append(records, at, end - at));
    at = end;
  }
}

void TileClient::finish_list() {
  send_pieces(1);
}

}  // namespace kdray::pdprt
