// Holdings of any number of ranks are the scene that one process has, word for word.
#include "cluster/partition/scene_partition.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <map>
#include <string>

#include "accel/flatten/scene_hash.h"
#include "cluster/partition/ply_files.h"
#include "cluster/partition/share.h"
#include "cluster/partition/together.h"
#include "pictures/scenes.h"
#include "scene/import/load.h"
#include "scene/primitives/shapes.h"
#include "scene/scratch.h"
#include "support/zero_area_meshes.h"

namespace kdray::test {
namespace {

using partition::ScenePartition;

constexpr int kRanks[] = {1, 2, 3, 4, 7, 8};

template <class T>
void append(std::string& bytes, const T* first, std::size_t n) {
  bytes.append(reinterpret_cast<const char*>(first), n * sizeof(T));
}

// All that belongs to each primitive, by kind and number.
using Words = std::map<std::pair<std::uint32_t, std::uint32_t>, std::string>;

void add_words(Words& words, const flatten::FlatScene& flat) {
  primitives::for_each_kind([&](auto kind) {
    using Kind = decltype(kind);
    for (std::size_t i = 0; i < Kind::of(flat).size(); ++i) {
      auto item = Kind::of(flat)[i];
      std::string bytes;
      if constexpr (!Kind::kIsShape) {
        if (item.normals != KDRAY_NO_NORMALS)
          append(bytes, &flat.normals[item.normals & KDRAY_NORMALS_MASK], 1);
        item.normals = item.normals == KDRAY_NO_NORMALS ? item.normals : item.normals & KDRAY_ZERO_AREA;
        const auto rows = [&](const auto& all) {
          const std::size_t each = all.size() / flat.triangles.size();
          append(bytes, all.data() + i * each, each);
        };
        rows(flat.corner_colors), rows(flat.texcoords);
      }
      append(bytes, &item, 1);
      EXPECT_TRUE(words.emplace(std::pair(Kind::kNumber, item.number), bytes).second)
          << "primitive " << item.number << " is held twice";
    }
  });
}

template <class T>
std::string bytes_of(const Array<T>& array) {
  return std::string(reinterpret_cast<const char*>(array.data()), array.bytes());
}

void expect_same_whole(const prepare::Prepared& one, const prepare::Prepared& held) {
  EXPECT_EQ(held.settings.warnings, one.settings.warnings);
  EXPECT_EQ(held.settings.name, one.settings.name);
  EXPECT_EQ(held.settings.materials, one.settings.materials);
  EXPECT_EQ(held.settings.texturing.material_maps, one.settings.texturing.material_maps);
  EXPECT_EQ(held.geometry.space, one.geometry.space);
  EXPECT_EQ(held.geometry.bounds.lo, one.geometry.bounds.lo);
  EXPECT_EQ(held.geometry.bounds.hi, one.geometry.bounds.hi);
  EXPECT_EQ(held.geometry.dropped_degenerate, one.geometry.dropped_degenerate);
  EXPECT_EQ(held.counts.primitives, one.counts.primitives);
  EXPECT_EQ(held.counts.triangles, one.counts.triangles);
  EXPECT_EQ(held.counts.spheres, one.counts.spheres);
  EXPECT_EQ(held.counts.zero_area, one.counts.zero_area);
  EXPECT_EQ(held.features, one.features);
  ASSERT_EQ(held.settings.camera.has_value(), one.settings.camera.has_value());
  if (one.settings.camera) {
    EXPECT_EQ(held.settings.camera->from, one.settings.camera->from);
    EXPECT_EQ(held.settings.camera->at, one.settings.camera->at);
  }
  EXPECT_EQ(bytes_of(held.flat.materials), bytes_of(one.flat.materials));
  EXPECT_EQ(bytes_of(held.flat.material_maps), bytes_of(one.flat.material_maps));
  EXPECT_EQ(bytes_of(held.flat.textures), bytes_of(one.flat.textures));
  EXPECT_EQ(bytes_of(held.flat.texels), bytes_of(one.flat.texels));
  EXPECT_EQ(bytes_of(held.flat.lights), bytes_of(one.flat.lights));
}

void expect_same_core(const flatten::Core& a, const flatten::Core& b) {
  EXPECT_EQ(a.lo, b.lo);
  EXPECT_EQ(a.hi, b.hi);
  EXPECT_EQ(a.face_lo, b.face_lo);
  EXPECT_EQ(a.face_hi, b.face_hi);
  EXPECT_EQ(a.has_faces, b.has_faces);
}

std::string bytes_of_cells(const ScenePartition& h) {
  std::string bytes;
  for (const partition::Cell& cell : h.cells) append(bytes, &cell.n, 1), append(bytes, &cell.bounds, 1);
  return bytes;
}

// That the rank's tree names each of its triangles, with the words that the triangle has.
void expect_tree_over_all(const prepare::Prepared& held) {
  const auto block = static_cast<std::size_t>(held.wide.block);
  const auto& words = held.wide.triangle_blocks;
  std::vector<bool> named(held.flat.triangles.size());
  for (std::size_t first = 0; first < words.size(); first += KDRAY_TRIANGLE_ROWS * block) {
    for (std::size_t lane = 0; lane < block; ++lane) {
      const auto word = [&](std::size_t row) { return words[first + row * block + lane]; };
      const layout::u32 index = word(KDRAY_ROW_TRIANGLE_INDEX);
      ASSERT_LT(index & KDRAY_REF_INDEX_MASK, std::max<std::size_t>(1, named.size()));
      const layout::Triangle& t = held.flat.triangles[index & KDRAY_REF_INDEX_MASK];
      named[index & KDRAY_REF_INDEX_MASK] = true;
      for (std::size_t k = 0; k < 9; ++k) ASSERT_EQ(word(k), std::bit_cast<layout::u32>(t.v[k / 3][k % 3]));
      if (index & KDRAY_WIDE_LAST) break;
    }
  }
  for (std::size_t i = 0; i < named.size(); ++i) EXPECT_TRUE(named[i]) << "no leaf has triangle " << i;
}

using MakePartition = std::function<ScenePartition(transport::Together&)>;

// What partition_scene() gives each rank against the scene in one process.
void expect_the_scene(const prepare::Prepared& one, const MakePartition& make_partition) {
  Words whole;
  add_words(whole, one.flat);
  std::string cells;
  const Hash primitives = flatten::hash_of_primitives(one.flat);
  for (const int n : kRanks) {
    SCOPED_TRACE(std::to_string(n) + " ranks");
    std::vector<ScenePartition> partitions(static_cast<std::size_t>(n));
    const auto ends = run_ranks(
        n,
        [&](transport::Together& all) {
          partitions[static_cast<std::size_t>(all.rank())] = make_partition(all);
        },
        static_cast<std::uint32_t>(n));
    for (const RankEnd& end : ends) ASSERT_EQ(end.error + std::to_string(end.code), "0");
    Words words;
    for (const ScenePartition& h : partitions) {
      add_words(words, h.prepared.flat);
      expect_same_whole(one, h.prepared);
      expect_same_core(h.core, flatten::core_of(one.flat));
      expect_tree_over_all(h.prepared);
      EXPECT_EQ(h.prepared.wide.block, partitions[0].prepared.wide.block);
      if (cells.empty()) cells = bytes_of_cells(h);
      EXPECT_EQ(bytes_of_cells(h), cells) << "other cells";
      EXPECT_EQ(h.primitives, primitives);
      EXPECT_EQ(flatten::scene_hash(h.primitives, h.prepared.flat),
                flatten::scene_hash(primitives, one.flat));
    }
    EXPECT_EQ(words.size(), whole.size());
    EXPECT_TRUE(words == whole) << "a primitive has other words";
  }
}

prepare::Prepared in_one(const std::filesystem::path& file) {
  return prepare::prepare(scene::load(file), TreeOptions());
}
MakePartition from(const std::filesystem::path& file) {
  return [file](transport::Together& all) { return partition::partition_scene(file, {}, {}, all).value(); };
}

TEST(ScenePartition, OfScenesThatEveryRankHas) {
  for (const NamedScene& s : small_scenes()) {
    SCOPED_TRACE(s.name);
    const scene::Scene scene = s.make();
    expect_the_scene(prepare::prepare(scene, TreeOptions()),
                     [&](transport::Together& all) { return partition::partition_scene(scene, {}, all); });
  }
}

TEST(ScenePartition, OfPlyFilesReadInShares) {
  const ScratchFolder folder;
  int i = 0;
  for (const PlyParts& parts :
       {PlyParts{}, PlyParts{.normals = true}, PlyParts{.colors = true},
        PlyParts{.normals = true, .colors = true, .big_endian = true, .quality = true}})
    for (const bool with_degenerate : {false, true}) {
      SCOPED_TRACE(std::to_string(i));
      const auto file = folder.write(std::to_string(i++) + ".ply", ball_ply(24, parts, with_degenerate));
      run_ranks(3, [&](transport::Together& all) {
        EXPECT_TRUE(partition::read_in_shares(file, {}, all)) << "every rank would read all of it";
      });
      expect_the_scene(in_one(file), from(file));
    }
}

TEST(ScenePartition, OfMeshesWithZeroArea) {
  const ScratchFolder folder;
  int i = 0;
  for (const LatticeMesh& mesh : zero_area_meshes()) {
    SCOPED_TRACE(mesh.name);
    PlyWriter ply(mesh.vertices.size(), mesh.triangles.size(), {});
    for (const auto& v : mesh.vertices)
      ply.vertex(static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2]));
    for (const auto& t : mesh.triangles)
      ply.face(static_cast<std::int32_t>(t[0]), static_cast<std::int32_t>(t[1]),
               static_cast<std::int32_t>(t[2]));
    const auto file = folder.write(std::to_string(i++) + ".ply", ply.text());
    expect_the_scene(in_one(file), from(file));
  }
}

// Each rank's share is what it is meant to be where cells are small.
TEST(ScenePartition, SharesAreAboutEqual) {
  const ScratchFolder folder;
  const auto file = folder.write("ball.ply", ball_ply(100, {}));
  std::vector<std::size_t> held(8);
  run_ranks(8, [&](transport::Together& all) {
    held[static_cast<std::size_t>(all.rank())] =
        partition::partition_scene(file, {}, {}, all)->prepared.flat.triangles.size();
  });
  for (const std::size_t n : held) EXPECT_NEAR(static_cast<double>(n), 40000.0 / 8, 40000.0 / 8 * 0.1);
}

TEST(ScenePartition, OfOddFilesSaysWhatOneProcessSays) {
  const ScratchFolder folder;
  const std::string good = ball_ply(4, {});
  std::map<std::string, std::string> files;
  files["cut.ply"] = good.substr(0, good.size() - 5);
  files["cut_in_vertices.ply"] = good.substr(0, good.size() / 4);
  files["empty.ply"] = "";
  files["header.ply"] = good.substr(0, 40);
  files["more.ply"] = good + "more";
  files["none.ply"] = PlyWriter(0, 0, {}).text();
  PlyWriter one(3, 1, {}), out(3, 2, {}), nan(3, 1, {}), same(3, 500, {}), quads(4, 1, {});
  for (PlyWriter* ply : {&one, &out, &same}) ply->vertex(0, 0, 0), ply->vertex(1, 0, 0), ply->vertex(0, 1, 0);
  one.face(0, 1, 2);
  out.face(0, 1, 2), out.face(0, 1, 3);
  nan.vertex(0, 0, 0), nan.vertex(1, NAN, 0), nan.vertex(0, 1, 0), nan.face(0, 1, 2);
  for (int i = 0; i < 500; ++i) same.face(0, 1, 2);
  files["one.ply"] = one.text(), files["range.ply"] = out.text(), files["nan.ply"] = nan.text();
  files["same.ply"] = same.text();
  for (const auto& [name, text] : files) {
    SCOPED_TRACE(name);
    const auto file = folder.write(name, text);
    std::string expected;
    std::optional<prepare::Prepared> whole;
    try {
      whole = in_one(file);
    } catch (const Error& error) {
      expected = error.what();
    }
    if (whole) {
      expect_the_scene(*whole, from(file));
      continue;
    }
    for (const int n : kRanks) {
      const auto ends = run_ranks(n, [&](transport::Together& all) { from(file)(all); });
      EXPECT_EQ(ends[0].error, expected);
      for (const RankEnd& end : ends) EXPECT_EQ(end.code, static_cast<int>(ErrorCode::input));
    }
  }
}

TEST(ScenePartition, OfAFileThatIsMissing) {
  for (const int n : kRanks) {
    const auto ends = run_ranks(n, [&](transport::Together& all) { from("/nowhere/scene.ply")(all); });
    EXPECT_EQ(ends[0].error, "/nowhere/scene.ply: no such file; check the path");
  }
}

}  // namespace
}  // namespace kdray::test
