#include "engine/pdprt/tile_server.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "engine/checkpoint/record.h"

namespace kdray::pdprt {

namespace {

constexpr std::size_t kPartsPerRank = 4;  // of its share of what is left, as Tiles has it for queues

}  // namespace

TileServer::TileServer(transport::Ranks& ranks, const SharedFrame& frame, const TileHierarchy& hierarchy)
    : ranks_(ranks),
      frame_(frame),
      hierarchy_(hierarchy),
      clients_(hierarchy.clients_of(ranks.rank())),
      n_served_(static_cast<std::size_t>(hierarchy.n_served_by(ranks.rank()))) {}

void TileServer::tell(transport::Tag tag, const transport::Bytes& bytes) {
  for (const int rank : clients_) ranks_.send(rank, tag, bytes);
}

void TileServer::start(const Begin& head, std::span<const layout::u32> samples, frame::Sink sink) {
  list_ = head.list;
  of_runs_ = head.of_runs != 0;
  bag_.clear();
  next_ = n_assigned_ = elsewhere_ = n_rendered_ = 0;
  assigned_to_.clear();
  rendered_.clear();
  waiting_.clear();
  own_prefetch_ = {};
  own_wants_.reset();
  sink_ = std::move(sink);
  tell(kBegin, to_bytes(head, samples));
}

void TileServer::begin(Begin head, std::vector<layout::u32> entries, std::span<const layout::u32> samples,
                       frame::Sink sink) {
  head.list = ranks_.next_number();
  head.n_entries = entries.size();
  start(head, samples, std::move(sink));
  bag_ = std::move(entries);
}

void TileServer::pass_on(const Begin& head, std::span<const layout::u32> samples, frame::Sink sink) {
  start(head, samples, std::move(sink));
  is_open_ = true;
}

void TileServer::add(std::span<const layout::u32> entries, std::size_t elsewhere) {
  bag_.insert(bag_.end(), entries.begin(), entries.end());
  elsewhere_ = elsewhere;
}

void TileServer::end() {
  is_open_ = false;
  elsewhere_ = 0;
}

std::size_t TileServer::left_for_each() const {
  return stock() / n_served_ + elsewhere_;
}

// At the end a rank that renders many tiles in a message's time gets up to half of its share. `n_served`: for
// how many ranks it is.
std::span<const layout::u32> TileServer::assign(std::size_t least, int n_served) {
  const std::size_t left = (stock() + elsewhere_ * n_served_) * static_cast<std::size_t>(n_served);
  const std::size_t part = left / (kPartsPerRank * n_served_),
                    most = (left + 2 * n_served_ - 1) / (2 * n_served_);
  const std::size_t n = std::min(std::max(part, std::min(least, most)), stock());
  const std::span<const layout::u32> entries = std::span(bag_).subspan(next_, n);
  next_ += n;
  return entries;
}

void TileServer::feed(Tiles& own) {
  const double now = ranks_.now();
  if (const auto least = own_prefetch_.ask(own.stock(), own.usual(), own.usual(), now)) own_wants_ = least;
  if (!own_wants_ || !can_assign()) return;
  const std::span<const layout::u32> entries = assign(*own_wants_, 1);
  own_wants_.reset();
  own_prefetch_.granted(entries.size(), now);
  own.add(entries, left_for_each());
  if (entries.empty()) own.end();
}

void TileServer::grant(const Request& request) {
  const std::span<const layout::u32> entries = assign(request.least, hierarchy_.n_served_by(request.rank));
  for (const layout::u32 entry : entries) assigned_to_[entry] = request.rank;
  n_assigned_ += entries.size();
  ranks_.send(request.rank, kGrant,
              to_bytes(Grant{list_, entries.empty() ? 1u : 0u, left_for_each()}, entries));
}

void TileServer::take_want(int rank, const Want& want) {
  if (want.list != list_) return;  // of a list that has ended meanwhile: it wants nothing any more
  std::size_t& rendered = rendered_[rank];
  n_rendered_ += want.n_rendered - rendered;
  rendered = want.n_rendered;
  waiting_.push_back({rank, want.least});
}

void TileServer::take_records(const transport::Message& message) {
  std::string_view bytes = std::string_view(message.bytes).substr(sizeof(Records));
  while (!bytes.empty()) {
    const auto head = checkpoint::head_of(bytes, frame_.frame);
    if (!head || head->bytes > bytes.size()) refuse(message);
    const layout::u32 entry = head->id.number;
    const auto assigned = assigned_to_.find(entry);
    if (assigned == assigned_to_.end() || assigned->second != message.from ||
        head->id.places != frame_.places_of(of_runs_, entry))
      refuse(message);
    // Heads and sums have whole words, and a message begins with one.
    const checkpoint::Sums sums(reinterpret_cast<const layout::i64*>(bytes.data() + checkpoint::kRecordHead),
                                head->id.places.sums());
    if (checkpoint::hash_of_sums(sums) != head->content) refuse(message);
    const checkpoint::Rectangle& r = head->id.places;
    sink_({{&sums, 1}, std::size_t{r.y} * r.width + r.x, r.width}, {&entry, 1});
    assigned_to_.erase(assigned);
    --n_assigned_;
    bytes.remove_prefix(head->bytes);
  }
}

void TileServer::answer(const transport::Message& message) {
  if (!hierarchy_.serves(ranks_.rank(), message.from)) refuse(message);
  if (message.tag == kWant) return take_want(message.from, head_of<Want>(message));
  if (message.tag != kRecords || head_of<Records>(message).list != list_) refuse(message);
  take_records(message);
}

void TileServer::step(Tiles& own) {
  feed(own);
  if (ranks_.leads())
    while (const auto message = ranks_.next(transport::kTagsOfTiles)) answer(*message);
  for (; !waiting_.empty() && can_assign(); waiting_.pop_front()) grant(waiting_.front());
}

std::vector<layout::u32> TileServer::close() {
  std::vector<layout::u32> left(bag_.begin() + static_cast<std::ptrdiff_t>(next_), bag_.end());
  bag_.resize(next_);
  return left;
}

void TileServer::finish() {
  reports_.clear();
  tell(kFinish, to_bytes(Finish{ranks_.number()}));
}

bool TileServer::take_reports() {
  while (auto message = ranks_.next(transport::kTagsOfTiles)) {
    if (message->tag == kWant) continue;  // was on its way when the last list ended
    if (message->tag != kReport) refuse(*message);
    reports_.push_back(std::move(*message));
  }
  return reports_.size() + 1 == static_cast<std::size_t>(ranks_.size());
}

}  // namespace kdray::pdprt
