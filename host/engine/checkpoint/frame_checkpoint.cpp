#include "engine/checkpoint/frame_checkpoint.h"

#include <fmt/format.h>

#include <algorithm>
#include <system_error>
#include <thread>
#include <utility>

#include "base/error.h"
#include "base/timer.h"
#include "engine/checkpoint/leases.h"

namespace kdray::checkpoint {

namespace fs = std::filesystem;

namespace {

constexpr const char* kHeaderFile = "frame.ledger";
constexpr std::size_t kMostChunks = 128;  // of a round: a chunk costs three small files
constexpr double kChunkSeconds = 2;       // of what is claimed at a time
constexpr std::size_t kPartsLeft = 4;     // no more is claimed than one in so many of what nobody has
constexpr auto kLook = std::chrono::milliseconds(50);
constexpr std::size_t kMostBytes = std::size_t{1} << 18;  // of records that are one write: what a cache holds

void make_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (!fs::is_directory(folder, error))
    throw input_error(folder.string(), 0, "the folder of a checkpoint can't be made",
                      "name a place where you may write");
}

// Adds the time that it lives to a sum.
class Timed {
 public:
  explicit Timed(double& sum) : sum_(sum) {}
  ~Timed() { sum_ += timer_.seconds(); }
  Timed(const Timed&) = delete;
  Timed& operator=(const Timed&) = delete;

 private:
  double& sum_;
  Timer timer_;
};

}  // namespace

FrameCheckpoint::FrameCheckpoint(const LedgerOptions& options, const Identity& identity, const Cut& wanted,
                                 bool cut_given, std::string maker)
    : options_(options), header_{identity, wanted, std::move(maker)} {
  make_folder(options_.folder);
  join(wanted, cut_given);
  frame_ = header_.frame();
  const std::string owner = new_owner();
  header_.maker = fmt::format("{} on {}", header_.maker, owner.substr(0, owner.find('-')));
  if (options_.share) heartbeat_.emplace(options_.folder, owner, options_.lease_seconds);
  file_ = std::make_unique<TileFile>(options_.folder, owner, header_);
  records_.emplace(options_.folder, header_, file_->path());
}

// The first process says what the checkpoint is of, and the others find it.
void FrameCheckpoint::join(const Cut& wanted, bool cut_given) {
  const fs::path file = options_.folder / kHeaderFile;
  if (create_once(file, to_bytes(header_))) return;
  if (!options_.share && !options_.resume)
    throw Error(ErrorCode::usage,
                fmt::format("{} has a checkpoint already; add --resume to go on from it, or name "
                            "another folder",
                            options_.folder.string()));
  std::optional<Header> found = header_of(read_small(file, kHeaderBytes));
  for (int i = 0; !found && i < 20;
       ++i) {  // where it is made without a link, it may be a moment until it is whole
    std::this_thread::sleep_for(kLook);
    found = header_of(read_small(file, kHeaderBytes));
  }
  if (!found)
    throw input_error(file.string(), 0, "is no checkpoint of this version of kdray, or is damaged",
                      "name another folder, or remove this one");
  check_same(options_.folder, found->identity, header_.identity);
  if (cut_given && found->cut != wanted)
    throw Error(ErrorCode::usage,
                fmt::format("the checkpoint in {} has tiles of {}x{}; leave --tile out, or give that",
                            options_.folder.string(), found->cut.tile_width, found->cut.tile_height));
  header_.cut = found->cut;
}

void FrameCheckpoint::begin(Round round) {
  const Timed timed(report_.seconds);
  if (round.number == 0) report_.records = report_.found = report_.rendered = 0;
  round_ = std::move(round);
  report_.records += round_.entries.size();
  present_.assign(round_.entries.size(), false);
  n_present_ = from_chunk_ = 0;
  index_.clear();
  for (std::size_t i = 0; i < round_.entries.size(); ++i) index_.emplace(round_.entries[i], i);
  std::vector<layout::i64> sums;
  for (std::size_t i = 0; i < round_.entries.size(); ++i) {
    const RecordId id = id_of(i);
    sums.resize(id.places.sums());
    if (records_->load(id, sums)) place(i, sums);
  }
  read_on();
  report_.found += n_present_;
  if (heartbeat_) open_chunks();
}

void FrameCheckpoint::open_chunks() {
  const std::size_t n = round_.entries.size();
  const std::size_t n_chunks =
      std::clamp<std::size_t>(n / round_.least_chunk, std::min<std::size_t>(n, 1), kMostChunks);
  chunks_.emplace(options_.folder, fmt::format("lot-{}", round_.number), 0, n_chunks, *heartbeat_);
}

RecordId FrameCheckpoint::id_of(std::size_t i) const {
  return {round_.number, round_.entries[i], round_.places(round_.entries[i])};
}

// Of the round's entries: the first, and the one behind the last.
std::pair<std::size_t, std::size_t> FrameCheckpoint::chunk(std::size_t number) const {
  const std::size_t n = round_.entries.size();
  return {number * n / chunks_->size(), (number + 1) * n / chunks_->size()};
}

void FrameCheckpoint::place(std::size_t i, Sums sums) {
  const Rectangle r = id_of(i).places;
  for (std::size_t row = 0; row < r.height; ++row) {
    const Sums from = sums.subspan(3 * row * r.width, std::size_t{3} * r.width);
    std::copy(from.begin(), from.end(), round_.sums.subspan(3 * ((r.y + row) * round_.pitch + r.x)).begin());
  }
  if (!present_[i]) ++n_present_;
  present_[i] = true;
}

Sums FrameCheckpoint::gather(const RecordId& id, std::vector<layout::i64>& to) const {
  const Rectangle& r = id.places;
  to.clear();
  for (std::size_t row = 0; row < r.height; ++row) {
    const Sums from = round_.sums.subspan(3 * ((r.y + row) * round_.pitch + r.x), std::size_t{3} * r.width);
    to.insert(to.end(), from.begin(), from.end());
  }
  return to;
}

void FrameCheckpoint::read_on() {
  records_->read_on([this](const RecordId& id, Sums sums) {
    if (id.round != round_.number) return;
    const auto found = index_.find(id.number);
    if (found == index_.end() || present_[found->second]) return;
    place(found->second, sums);
  });
}

std::vector<layout::u32> FrameCheckpoint::missing(std::size_t first, std::size_t end) const {
  std::vector<layout::u32> entries;
  for (std::size_t i = first; i < end; ++i)
    if (!present_[i]) entries.push_back(round_.entries[i]);
  return entries;
}

std::vector<layout::u32> FrameCheckpoint::missing_of_own() {
  std::vector<layout::u32> all;
  for (std::size_t l = 0; l < chunks_->size(); ++l) {
    if (!chunks_->is_mine(l)) continue;
    const auto [first, end] = chunk(l);
    const std::vector<layout::u32> entries = missing(first, end);
    all.insert(all.end(), entries.begin(), entries.end());
  }
  return all;
}

// What takes some seconds, by what the last ones took.
std::size_t FrameCheckpoint::chunks_to_claim(std::size_t n_free) const {
  const double chunk_entries =
      static_cast<double>(round_.entries.size()) / static_cast<double>(chunks_->size());
  const auto wanted = static_cast<std::size_t>(entries_per_second_ * kChunkSeconds / chunk_entries);
  return std::clamp<std::size_t>(std::min(wanted, n_free / kPartsLeft), 1, n_free);
}

// A run of the curve from where the last one ended. False: nothing is free.
bool FrameCheckpoint::claim_chunks() {
  chunks_->look();
  const std::size_t n = chunks_->size();
  std::size_t n_free = 0;
  for (std::size_t l = 0; l < n; ++l) n_free += chunks_->is_free(l) ? 1 : 0;
  if (n_free == 0) return false;
  std::size_t left = chunks_to_claim(n_free);
  bool inherited = false;
  for (std::size_t k = 0; k < n && left > 0; ++k) {
    const std::size_t l = (from_chunk_ + k) % n;
    if (!chunks_->is_free(l) || !chunks_->claim(l)) continue;
    inherited = inherited || chunks_->was_held(l);
    from_chunk_ = l + 1;
    --left;
  }
  if (inherited) read_on();  // its last owner may have left some of it
  return true;
}

std::vector<layout::u32> FrameCheckpoint::next(const std::function<void()>& idle) {
  const Timed timed(report_.seconds);
  given_ = Clock::now();
  if (!chunks_) return missing(0, round_.entries.size());
  for (const Timer waited;; std::this_thread::sleep_for(kLook)) {
    do {
      finish_chunks();
      std::vector<layout::u32> entries = missing_of_own();
      given_ = Clock::now();
      if (!entries.empty()) return entries;
    } while (claim_chunks());
    if (chunks_->all_done()) {
      read_on();
      return missing(0, round_.entries.size());  // what was damaged, though it is said to be done
    }
    if (waited.seconds() > options_.lease_seconds) {
      std::vector<layout::u32> entries = missing_of_others();
      given_ = Clock::now();
      if (!entries.empty()) return entries;
    }
    if (idle) idle();
  }
}

// A chunk that another process has had for long: it may be slow, or hang, and there is nothing else to do.
// Whichever of them is second finds that its tiles are the same.
std::vector<layout::u32> FrameCheckpoint::missing_of_others() {
  read_on();
  for (std::size_t k = 0; k < chunks_->size(); ++k) {
    const auto [first, end] = chunk((from_chunk_ + k) % chunks_->size());
    std::vector<layout::u32> entries = missing(first, end);
    if (entries.empty()) continue;
    from_chunk_ += k + 1;
    return entries;
  }
  return {};
}

void FrameCheckpoint::keep(std::span<const layout::u32> entries) {
  const double taken = std::chrono::duration<double>(Clock::now() - given_).count();
  const Timed timed(report_.seconds);
  std::string records;
  records.reserve(2 * kMostBytes);
  std::vector<layout::i64> sums;
  const auto append = [&] {
    report_.bytes_written += records.size();
    try {
      file_->append(records);
    } catch (const Error& error) {
      if (options_.share) throw;
      failure_ = error.what();
    }
    records.clear();
  };
  for (const layout::u32 entry : entries) {
    const std::size_t i = index_.at(entry);
    const RecordId id = id_of(i);
    const Sums of_entry = gather(id, sums);
    const Hash content = hash_of_sums(of_entry);
    records_->add(id, content);
    append_record(records, frame_, id, of_entry, content);
    if (!present_[i]) ++n_present_;
    present_[i] = true;
    if (records.size() > kMostBytes) append();
  }
  append();
  report_.rendered += entries.size();
  if (taken > 0) entries_per_second_ = static_cast<double>(entries.size()) / taken;
  given_ = Clock::now();
  if (!chunks_) return file_->sync_meanwhile();
  file_->sync();  // what is said to be done has to be seen by all
  finish_chunks();
}

// Where another process has said so already, both have made it: that is compared.
void FrameCheckpoint::finish_chunks() {
  bool twice = false;
  for (std::size_t l = 0; l < chunks_->size(); ++l) {
    const auto [first, end] = chunk(l);
    if (!chunks_->is_done(l) && missing(first, end).empty()) twice = !chunks_->finish(l) || twice;
  }
  if (twice) read_on();
}

Report FrameCheckpoint::report() const {
  Report report = report_;
  report.damaged = records_->damaged();
  report.bytes_read = records_->bytes_read();
  return report;
}

std::vector<std::string> FrameCheckpoint::warnings() const {
  std::vector<std::string> lines;
  if (const std::uint64_t n = records_->damaged(); n > 0)
    lines.push_back(fmt::format("{} damaged {} in the checkpoint {}: what was in {} was traced again", n,
                                n == 1 ? "place" : "places", options_.folder.string(),
                                n == 1 ? "it" : "them"));
  if (!failure_.empty())
    lines.push_back(fmt::format("{}; the picture is made without a checkpoint from there on", failure_));
  return lines;
}

}  // namespace kdray::checkpoint
