#include "engine/checkpoint/record_index.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <system_error>
#include <utility>

#include "base/error.h"
#include "engine/checkpoint/record_file.h"

namespace kdray::checkpoint {

namespace fs = std::filesystem;

namespace {

std::uint64_t key_of(const RecordId& id) {
  return std::uint64_t{id.round} << 32 | id.number;
}

std::string in_words(const RecordId& id) {
  return id.round == 0 ? fmt::format("the tile at {},{}", id.places.x, id.places.y)
                       : fmt::format("run {} of round {} of adaptive sampling", id.number, id.round);
}

}  // namespace

RecordIndex::RecordIndex(fs::path folder, const Header& header, fs::path own)
    : folder_(std::move(folder)), header_(header), frame_(header.frame()), own_(std::move(own)) {}

// In the order of their names, so that a message doesn't depend on the file system.
void RecordIndex::find_files() {
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

std::string RecordIndex::maker_of(std::size_t file) const {
  if (file == kOwn) return header_.maker;
  const RecordFile& f = files_[file];
  return f.maker().empty() ? f.path().filename().string() : f.maker();
}

// Whether it was not known.
bool RecordIndex::note(const RecordId& id, const Known& known) {
  const auto [found, is_new] = known_.try_emplace(key_of(id), known);
  if (is_new) return true;
  const Known& before = found->second;
  if (before.content != known.content)
    throw input_error(folder_.string(), 0,
                      fmt::format("{} was made twice, and the results differ: by {}, and by {}; one of these "
                                  "machines computes wrongly",
                                  in_words(id), maker_of(before.file), maker_of(known.file)),
                      "find out which ('kdray verify' on both), and begin anew without it");
  return false;
}

void RecordIndex::read_on(const Take& take) {
  find_files();
  for (std::size_t i = 0; i < files_.size(); ++i)
    files_[i].read_on([&](const RecordHead& head, std::uint64_t offset, Sums sums) {
      // None that kdray writes is of other places than its number says.
      if (head.id.places != places_of(header_.cut, head.id.round, head.id.number)) return;
      if (note(head.id, {head.id.places, head.content, i, offset}) && take) take(head.id, sums);
    });
}

void RecordIndex::add(const RecordId& id, const Hash& content) {
  note(id, {id.places, content, kOwn, 0});
}

bool RecordIndex::load(const RecordId& id, std::span<layout::i64> sums) const {
  const auto found = known_.find(key_of(id));
  if (found == known_.end() || found->second.file == kOwn || found->second.places != id.places) return false;
  const Known& known = found->second;
  return files_[known.file].load(known.offset, known.content, sums);
}

std::uint64_t RecordIndex::damaged() const {
  return std::accumulate(files_.begin(), files_.end(), std::uint64_t{0},
                         [](std::uint64_t n, const RecordFile& file) { return n + file.damaged(); });
}

std::uint64_t RecordIndex::bytes_read() const {
  return std::accumulate(files_.begin(), files_.end(), std::uint64_t{0},
                         [](std::uint64_t n, const RecordFile& file) { return n + file.bytes_read(); });
}

}  // namespace kdray::checkpoint
