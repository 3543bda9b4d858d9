#include "bench/ranks/record_costs.h"

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "base/median.h"
#include "base/timer.h"
#include "ledger/record.h"

namespace kdray::bench {

namespace {

constexpr int kTiles = 512, kRepeat = 9;

}  // namespace

RecordCosts record_costs(int tile_width, int tile_height) {
  const auto width = static_cast<std::uint32_t>(tile_width), height = static_cast<std::uint32_t>(tile_height);
  const ledger::Rectangle places{0, 0, width, height};
  const std::vector<layout::i64> film(places.sums() * kTiles, 12345);
  std::vector<layout::i64> picture(film.size());
  const Hash frame = hash_of(std::string("a frame"));
  std::vector<double> deliver, take_back;
  for (int round = 0; round < kRepeat; ++round) {
    const Timer timer;
    std::string records;
    for (std::uint32_t tile = 0; tile < kTiles; ++tile) {
      const auto from = std::span(film).subspan(tile * places.sums(), places.sums());
      const std::vector<layout::i64> sums(from.begin(), from.end());
      ledger::append_record(records, frame, {0, tile, places}, sums, ledger::hash_of_sums(sums));
    }
    deliver.push_back(timer.seconds() / kTiles);
    const Timer back;
    std::string_view rest = records;
    for (std::size_t tile = 0; !rest.empty(); ++tile) {
      const auto head = ledger::head_of(rest, frame);
      const ledger::Sums sums(reinterpret_cast<const layout::i64*>(rest.data() + ledger::kRecordHead),
                              places.sums());
      if (ledger::hash_of_sums(sums) != head->content) break;
      std::copy(sums.begin(), sums.end(),
                picture.begin() + static_cast<std::ptrdiff_t>(tile * places.sums()));
      rest.remove_prefix(head->bytes);
    }
    take_back.push_back(back.seconds() / kTiles);
  }
  return {median(deliver), median(take_back)};
}

}  // namespace kdray::bench
