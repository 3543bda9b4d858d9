// What    PDPRT's ranks tell each other about a list of tiles: to the rank that serves them, or to one that
//         is served, which serves others as well where the first byte says so. A message of records has one,
//         with the right checksums.
#include "engine/pdprt/tile_client.h"
#include "engine/pdprt/tile_server.h"
#include "fuzz/records.h"
#include "fuzz/script.h"

namespace {

using namespace kdray;
using namespace kdray::pdprt;

const SharedFrame kFrame{{1, 2}, 6, 4, 2, 2};
constexpr std::size_t kTiles = 6;
constexpr int kRanks = 4;

std::vector<layout::u32> all_tiles() {
  std::vector<layout::u32> tiles;
  for (layout::u32 row = 0; row < 2; ++row)
    for (layout::u32 column = 0; column < 3; ++column) tiles.push_back(KDRAY_TILE(column, row));
  return tiles;
}

void check_films(const wavefront::PlacedFilms& films, std::span<const layout::u32> entries) {
  if (films.films.empty() || entries.empty()) fuzz::fail("sums of nothing");
}

void amend_records(transport::Message& message) {
  if (message.tag != kRecords || message.bytes.size() < sizeof(Records)) return;
  const std::string record = message.bytes.substr(sizeof(Records));
  message.bytes.replace(sizeof(Records), record.size(), fuzz::with_checksums(record, kFrame.frame));
}

// Until the script is over.
void serve(transport::Ranks& ranks, bool of_runs, const TileHierarchy& hierarchy) {
  TileServer server(ranks, kFrame, hierarchy);
  Tiles own = Tiles::open(1, kTiles);
  const std::vector<layout::u32> samples(2 * 256);
  server.begin({.of_runs = of_runs ? 1u : 0u}, of_runs ? std::vector<layout::u32>{0} : all_tiles(), samples,
               check_films);
  while (!server.is_done()) server.step(own);
  server.finish();
  while (!server.take_reports()) continue;
}

void be_served(transport::Ranks& ranks, const TileHierarchy& hierarchy) {
  TileClient client(ranks, kFrame, hierarchy);
  while (!client.is_finished()) {
    const auto list = client.next_list();
    if (!list) continue;
    if (list->head.n_entries > kTiles) return;
    Tiles tiles = Tiles::open(1, list->head.n_entries);
    for (int step = 0; step < 20; ++step) {
      client.step(tiles, 0);
      if (!tiles.take(0, {.most = 3, .least = 1, .ahead = 0}).empty()) tiles.done(0);
    }
    client.finish_list();
  }
}

}  // namespace

KDRAY_FUZZ(pdprt, bytes) {
  fuzz::Input input(bytes);
  const auto which = input.take<std::uint8_t>();
  const TileHierarchy hierarchy(kRanks, which & 1 ? 2 : 64);
  if (which & 2)
    return fuzz::plays(
        0, kRanks, input.rest(), transport::kTagsOfTiles,
        [&](transport::Ranks& ranks) { serve(ranks, which & 4, hierarchy); }, amend_records);
  return fuzz::plays(
      which & 4 ? 2 : 1, kRanks, input.rest(), transport::kTagsOfTiles,
      [&](transport::Ranks& ranks) { be_served(ranks, hierarchy); }, amend_records);
}
