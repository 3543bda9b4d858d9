#include "engine/checkpoint/catalogue.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <system_error>
#include <utility>

#include "base/error.h"
#include "engine/checkpoint/tile_file.h"

namespace kdray::ledger {

namespace fs = std::filesystem;

namespace {

std::uint64_t key_of(const Piece& piece) {
  return std::uint64_t{piece.round} << 32 | piece.number;
}

std::string in_words(const Piece& piece) {
  return piece.round == 0 ? fmt::format("the tile at {},{}", piece.places.x, piece.places.y)
                          : fmt::format("run {} of round {} of adaptive sampling", piece.number, piece.round);
}

}  // namespace

Catalogue::Catalogue(fs::path folder, const Header& header, fs::path own)
    : folder_(std::move(folder)), header_(header), frame_(header.frame()), own_(std::move(own)) {}

// In the order of their names, so that a message doesn't depend on the file system.
void Catalogue::find_files() {
  std::vector<fs::path> found;
  std::error_code error;
  for (fs::directory_iterator entry(folder_, error), end; !error && entry != end; entry.increment(error)) {
    const fs::path& path = entry->path();
    const auto is_it = [&](const RecordFile& file) { return file.path() == path; };
    if (path.extension() == kTilesEnding && path != own_ && std::ranges::none_of(files_, is_it))
      found.push_back(path);
  }
  std::ranges::sort(found);
  for (fs::path& path : found) files_.emplace_back(std::move(path), frame_);
}

std::string Catalogue::maker_of(std::size_t file) const {
  if (file == kOwn) return header_.maker;
  const RecordFile& f = files_[file];
  return f.maker().empty() ? f.path().filename().string() : f.maker();
}

// Whether it was not known.
bool Catalogue::note(const Piece& piece, const Known& known) {
  const auto [found, is_new] = known_.try_emplace(key_of(piece), known);
  if (is_new) return true;
  const Known& before = found->second;
  if (before.content != known.content)
    throw input_error(folder_.string(), 0,
                      fmt::format("{} was made twice, and the results differ: by {}, and by {}; one of these "
                                  "machines computes wrongly",
                                  in_words(piece), maker_of(before.file), maker_of(known.file)),
                      "find out which ('kdray verify' on both), and begin anew without it");
  return false;
}

void Catalogue::read_on(const Take& take) {
  find_files();
  for (std::size_t i = 0; i < files_.size(); ++i)
    files_[i].read_on([&](const RecordHead& head, std::uint64_t offset, Sums sums) {
      // None that kdray writes is of other places than its number says.
      if (head.piece.places != places_of(header_.cut, head.piece.round, head.piece.number)) return;
      if (note(head.piece, {head.piece.places, head.content, i, offset}) && take) take(head.piece, sums);
    });
}

void Catalogue::add(const Piece& piece, const Hash& content) {
  note(piece, {piece.places, content, kOwn, 0});
}

bool Catalogue::load(const Piece& piece, std::span<layout::i64> sums) const {
  const auto found = known_.find(key_of(piece));
  if (found == known_.end() || found->second.file == kOwn || found->second.places != piece.places)
    return false;
  const Known& known = found->second;
  return files_[known.file].load(known.offset, known.content, sums);
}

std::uint64_t Catalogue::damaged() const {
  return std::accumulate(files_.begin(), files_.end(), std::uint64_t{0},
                         [](std::uint64_t n, const RecordFile& file) { return n + file.damaged(); });
}

std::uint64_t Catalogue::bytes_read() const {
  return std::accumulate(files_.begin(), files_.end(), std::uint64_t{0},
                         [](std::uint64_t n, const RecordFile& file) { return n + file.bytes_read(); });
}

}  // namespace kdray::ledger
