#include "cluster/partition/vertices.h"

#include <algorithm>
#include <span>
#include <utility>

#include "cluster/partition/primitive_set.h"
#include "cluster/partition/wire.h"

namespace kdray::partition {

using scene::ply::Vertices;
using transport::Bytes;

VertexHolders::VertexHolders(transport::Together& all, const scene::ply::Rows& rows, Vertices own)
    : all_(all),
      n_vertices_(rows.n_vertices()),
      columns_(rows.columns()),
      first_(slice_of(n_vertices_, all.rank(), all.size()).first),
      own_(std::move(own)),
      used_(own_.places.size()) {}

// What each rank wants of this one, as places among its own.
std::vector<std::vector<std::uint32_t>> VertexHolders::ask(const std::vector<std::uint32_t>& wanted) {
  std::vector<Bytes> out(static_cast<std::size_t>(all_.size()));
  auto first = wanted.begin();
  for (int to = 0; to < all_.size(); ++to) {
    const auto last = std::lower_bound(first, wanted.end(), slice_of(n_vertices_, to, all_.size()).last);
    out[static_cast<std::size_t>(to)] = transport::bytes_of_list(std::span(first, last));
    first = last;
  }
  const std::vector<Bytes> in = all_.exchange(std::move(out));
  std::vector<std::vector<std::uint32_t>> asked(in.size());
  for (std::size_t from = 0; from < in.size(); ++from) {
    WireReader reader(in[from], static_cast<int>(from));
    reader.take(asked[from], in[from].size() / sizeof(std::uint32_t));
    reader.end();
    for (std::uint32_t& vertex : asked[from]) {
      vertex = static_cast<std::uint32_t>(vertex - first_);  // what is before the first becomes large
      if (vertex >= own_.places.size()) transport::throw_odd_message(static_cast<int>(from));
    }
  }
  return asked;
}

void VertexHolders::use(const std::vector<std::uint32_t>& wanted) {
  for (const auto& asked : ask(wanted))
    for (const std::uint32_t vertex : asked) used_[vertex] = 1;
}

DBox VertexHolders::bounds_of_used() {
  DBox box;
  for (std::size_t i = 0; i < used_.size(); ++i)
    if (used_[i] != 0) box.grow(own_.places[i]);
  return all_.join_values(box, [](DBox& sum, const DBox& one) { sum.grow(one); });
}

Vertices VertexHolders::fetch(const std::vector<std::uint32_t>& wanted) {
  const auto asked = ask(wanted);
  std::vector<Bytes> out(asked.size());
  for (std::size_t to = 0; to < asked.size(); ++to) {
    WireWriter writer(out[to]);
    writer.put_some(own_.places, asked[to]);
    if (!own_.normals.empty()) writer.put_some(own_.normals, asked[to]);
    if (!own_.colors.empty()) writer.put_some(own_.colors, asked[to]);
  }
  const std::vector<Bytes> in = all_.exchange(std::move(out));
  Vertices found;
  auto first = wanted.begin();
  for (int from = 0; from < all_.size(); ++from) {
    const auto last = std::lower_bound(first, wanted.end(), slice_of(n_vertices_, from, all_.size()).last);
    const auto n = static_cast<std::size_t>(last - first);
    WireReader reader(in[static_cast<std::size_t>(from)], from);
    reader.take(found.places, n);
    if (columns_.has_normals) reader.take(found.normals, n);
    if (columns_.has_colors) reader.take(found.colors, n);
    reader.end();
    first = last;
  }
  return found;
}

}  // namespace kdray::partition
