// What    The checkpoint of one frame: which tiles and runs are finished, in this process or in another, now
//         or in a run before; which of the others this process is to render next; and where those go that it
//         has rendered.
// Shape   A mode begins a round with the list of its entries and the place of their sums, then takes what is
//         next and hands in what is finished until nothing is next: all sums are in their places then.
//         Alone, a process gets all that is missing and is to hand in what it has every few seconds. With
//         others it gets chunks (neighbours on the curve) that it has a lease of: as many as take some
//         seconds, fewer as the end comes near.
// Errors  ErrorCode::input: a folder that can't be written, a checkpoint of something else, records of one
//         entry that differ. ErrorCode::usage: a checkpoint is there although none is to be gone on from.
// Source  docs/design/checkpoint.md.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/checkpoint/header.h"
#include "engine/checkpoint/leases.h"
#include "engine/checkpoint/record_file.h"
#include "engine/checkpoint/record_index.h"
#include "kdray/options.h"

namespace kdray::checkpoint {

// What is finished together with nothing left over: all tiles of a picture, or all runs of a list of samples.
struct Round {
  std::uint32_t number = 0;
  std::vector<layout::u32> entries = {};              // in an order in which neighbours are alike
  std::function<Rectangle(layout::u32)> places = {};  // of an entry
  std::size_t pitch = 0;                              // places from one row to the next in `sums`
  std::span<layout::i64> sums = {};
  std::size_t least_chunk = 1;  // entries that are worth a lease
};

struct Report {
  std::uint64_t records = 0, found = 0, rendered = 0;  // of all rounds
  std::uint64_t damaged = 0, bytes_read = 0, bytes_written = 0;
  double seconds = 0;  // in which this process did nothing else but read, write and wait for others
};

class FrameCheckpoint {
 public:
  // `wanted` is how this run would cut the picture into tiles; a checkpoint that is there says how it is
  // done, and is refused where `cut_given` and it does it otherwise.
  FrameCheckpoint(const LedgerOptions& options, const Identity& identity, const Cut& wanted, bool cut_given,
                  std::string maker);

  const Cut& cut() const { return header_.cut; }

  // A frame may be begun again with round 0.
  void begin(Round round);

  // What is to be rendered now; nothing: the round is done. `idle` is called while others are waited for.
  std::vector<layout::u32> next(const std::function<void()>& idle = {});

  // How long that may take before what is finished is to be handed in.
  double seconds() const { return options_.every_seconds; }

  // Their sums are in their places.
  void keep(std::span<const layout::u32> entries);

  // Of the round, as far as this process knows.
  std::size_t n_present() const { return n_present_; }
  std::size_t n_entries() const { return round_.entries.size(); }

  Report report() const;
  // What went wrong on the way, one line each.
  std::vector<std::string> warnings() const;

 private:
  using Clock = std::chrono::steady_clock;

  void join(const Cut& wanted, bool cut_given);
  void open_chunks();
  RecordId id_of(std::size_t i) const;
  std::pair<std::size_t, std::size_t> chunk(std::size_t number) const;
  void place(std::size_t i, Sums sums);
  Sums gather(const RecordId& id, std::vector<layout::i64>& to) const;
  void read_on();
  std::vector<layout::u32> missing(std::size_t first, std::size_t end) const;
  std::vector<layout::u32> missing_of_own();
  bool claim_chunks();
  std::vector<layout::u32> missing_of_others();
  void finish_chunks();
  std::size_t chunks_to_claim(std::size_t n_free) const;

  LedgerOptions options_;
  Header header_;
  Hash frame_;
  std::optional<Heartbeat> heartbeat_;  // of a shared checkpoint
  std::unique_ptr<TileFile> file_;
  std::optional<RecordIndex> records_;
  std::optional<Leases> chunks_;
  Round round_;
  std::unordered_map<layout::u32, std::size_t> index_;  // of the entries
  std::vector<bool> present_;
  std::size_t n_present_ = 0, from_chunk_ = 0;
  Clock::time_point given_;  // when next() gave what is in work
  double entries_per_second_ = 0;
  Report report_;
  std::string failure_;  // the checkpoint can't be written any more
};

}  // namespace kdray::checkpoint
