
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>

#include "accel/kdtree/binned/binned.h"
#include "accel/kdtree/binned/piece.h"
#include "accel/kdtree/fragment.h"

namespace kdray::kdtree::binned {

namespace {

// Returns how many references a cell may have to be built in one thread, for n in all: there are enough such
// cells for any number of threads, and each fits a core's cache.
std::size_t subtree_refs(std::size_t n) {
  return std::clamp<std::size_t>(n / 32, 2048, 32768);
}

std::size_t n_pieces_of(std::size_t n_refs) {
  return (n_refs + kTaskRefs - 1) / kTaskRefs;
}

// A cell of the top, and where its node goes.
struct TopCell {
  TopNode* node;
  Cell cell;
  std::size_t n = 0;
  std::vector<Piece> pieces;
  bool is_leaf = false;  // however many references it has
};

// What a task finds on one side of its cell's plane.
struct Side {
  std::vector<Piece> pieces;
  Bounds contents = no_bounds();

  void add(const Piece& piece) {
    contents = hull(contents, piece.hull);
    pieces.push_back(piece);
  }
  void add_divided(Piece piece) {
    if (piece.n == 0) return;
    piece.hull = fast_hull_of(piece.refs());
    add(piece);
  }
};

// Pieces of one cell, about kTaskRefs references in all, and what they become.
struct Task {
  std::size_t cell, first_piece, end_piece;
  BinCounts counts;
  std::size_t n_straddling = 0;
  Side below, above;
};

class TopBuilder {
 public:
  TopBuilder(const scene::Geometry& geometry, const BuildConfig& config, int max_depth)
      : geometry_(geometry),
        config_(config),
        max_depth_(max_depth),
        subtree_refs_(subtree_refs(geometry.size())),
        pool_(geometry.size() + n_pieces_of(geometry.size())) {}

  std::unique_ptr<TopNode> run(Bounds& bounds) {
    auto root = std::make_unique<TopNode>();
    std::vector<TopCell> level;
    place(whole_scene(*root), level);
    bounds = (level.empty() ? subtrees_ : level).front().cell.contents;
    while (!level.empty()) level = next_level(std::move(level));
    build_subtrees();
    return root;
  }

 private:
  TopCell whole_scene(TopNode& root) {
    const std::size_t n = geometry_.size(), n_pieces = n_pieces_of(n);
    TopCell cell{&root, {no_bounds(), 0, reference_budget(n, config_.quality)}, n, {}, false};
    cell.pieces.resize(n_pieces);
    for (std::size_t i = 0; i < n_pieces; ++i)
      cell.pieces[i] = pool_.take(std::min(kTaskRefs, n - i * kTaskRefs));
    tbb::parallel_for(std::size_t{0}, n_pieces, [&](std::size_t i) {
      Piece& piece = cell.pieces[i];
      piece.n = most_in(piece);
      for (std::size_t k = 0; k < piece.n; ++k) piece.first[k] = reference(i * kTaskRefs + k);
      piece.hull = fast_hull_of(piece.refs());
    });
    for (const Piece& piece : cell.pieces) cell.cell.contents = hull(cell.cell.contents, piece.hull);
    return cell;
  }

  // Returns the reference of the i-th of all primitives.
  BoundedRef reference(std::size_t i) const {
    BoundedRef found;
    scene::visit_primitive(geometry_, i, [&](auto kind, std::uint32_t index) {
      const Bounds b = bounds_from(scene::bounds_of(decltype(kind)::of(geometry_)[index]));
      found = {b.lo, make_ref(decltype(kind)::kKind, index), b.hi};
    });
    return found;
  }

  // Puts large cells in the next level, small ones among the subtrees.
  void place(TopCell&& cell, std::vector<TopCell>& level) {
    cell.is_leaf = cell.cell.depth >= max_depth_;
    const bool small = cell.n <= subtree_refs_ || cell.is_leaf;
    (small ? subtrees_ : level).push_back(std::move(cell));
  }

  std::vector<TopCell> next_level(std::vector<TopCell>&& level) {
    std::vector<BinGrid> grids;
    for (const TopCell& c : level) grids.push_back(make_bin_grid(c.cell.contents));
    std::vector<Task> tasks = tasks_of(level);
    for_tasks(tasks, [&](Task& t) {
      for (std::size_t p = t.first_piece; p < t.end_piece; ++p)
        count(level[t.cell].pieces[p].refs(), grids[t.cell], sample_stride(level[t.cell].n), t.counts);
    });
    std::vector<Plane> planes = choose_planes(level, grids, tasks);
    drop_unaffordable(level, tasks, planes);
    for_tasks(tasks, [&](Task& t) {
      if (planes[t.cell].found()) divide_task(level[t.cell], planes[t.cell], t);
    });
    return children(std::move(level), planes, tasks);
  }

  static std::vector<Task> tasks_of(const std::vector<TopCell>& level) {
    std::vector<Task> tasks;
    for (std::size_t c = 0; c < level.size(); ++c) {
      const std::vector<Piece>& pieces = level[c].pieces;
      for (std::size_t p = 0; p < pieces.size();) {
        const std::size_t first = p;
        for (std::size_t n = 0; p < pieces.size() && n + pieces[p].n <= kTaskRefs; ++p) n += pieces[p].n;
        tasks.push_back({c, first, p, {}, 0, {}, {}});
      }
    }
    return tasks;
  }

  template <class Work>
  static void for_tasks(std::vector<Task>& tasks, const Work& work) {
    tbb::parallel_for(
        std::size_t{0}, tasks.size(), [&](std::size_t i) { work(tasks[i]); }, tbb::simple_partitioner());
  }

  std::vector<Plane> choose_planes(const std::vector<TopCell>& level, const std::vector<BinGrid>& grids,
                                   const std::vector<Task>& tasks) const {
    std::vector<BinCounts> counts(level.size());
    for (const Task& t : tasks) counts[t.cell].add(t.counts);
    std::vector<Plane> planes(level.size());
    for (std::size_t c = 0; c < level.size(); ++c)
      planes[c] = best_plane(counts[c], grids[c], level[c].cell.contents, level[c].n, config_);
    return planes;
  }

  // Finds out before a cell is divided whether its parts fit the budget, since it is divided in place. Where
  // even twice the references would fit, nothing need be counted.
  static void drop_unaffordable(const std::vector<TopCell>& level, std::vector<Task>& tasks,
                                std::vector<Plane>& planes) {
    const auto tight = [&](std::size_t c) {
      return planes[c].found() && !fits_budget(level[c].cell.budget, level[c].n, level[c].n);
    };
    for_tasks(tasks, [&](Task& t) {
      if (!tight(t.cell)) return;
      const Plane& plane = planes[t.cell];
      for (std::size_t p = t.first_piece; p < t.end_piece; ++p) {
        const Piece& piece = level[t.cell].pieces[p];
        if (!piece.is_below(plane) && !piece.is_above(plane))
          t.n_straddling += n_straddling(piece.refs(), plane);
      }
    });
    std::vector<std::size_t> straddling(level.size(), 0);
    for (const Task& t : tasks) straddling[t.cell] += t.n_straddling;
    for (std::size_t c = 0; c < level.size(); ++c)
      if (tight(c) && !fits_budget(level[c].cell.budget, level[c].n, straddling[c])) planes[c] = {};
  }

  // Divides a task's pieces. Those on one side go there as they are. In others, what is below stays in front
  // and what is above goes behind it; further references above, one for each that straddles, go to a piece of
  // their own.
  void divide_task(const TopCell& cell, const Plane& plane, Task& t) {
    Workspace& workspace = workspaces_.local();
    std::vector<BoundedRef>& others = workspace.others;
    others.clear();
    for (std::size_t p = t.first_piece; p < t.end_piece; ++p) {
      const Piece& whole = cell.pieces[p];
      if (whole.is_below(plane)) {
        t.below.add(whole);
        continue;
      }
      if (whole.is_above(plane)) {
        t.above.add(whole);
        continue;
      }
      const Divided sides = divide(geometry_, config_, whole.refs(), plane, workspace);
      Piece above = rest_of(whole, sides.n_below);
      above.n = std::min(most_in(above), sides.n_above);
      const auto from = workspace.above.begin(), rest = from + static_cast<std::ptrdiff_t>(above.n);
      std::copy(from, rest, above.first);
      others.insert(others.end(), rest, from + static_cast<std::ptrdiff_t>(sides.n_above));
      t.below.add_divided({whole.first, sides.n_below, sides.n_below + 1, no_bounds()});
      t.above.add_divided(above);
    }
    if (others.empty()) return;
    Piece more = pool_.take(others.size());
    more.n = others.size();
    std::copy(others.begin(), others.end(), more.first);
    t.above.add_divided(more);
  }

  std::vector<TopCell> children(std::vector<TopCell>&& level, const std::vector<Plane>& planes,
                                const std::vector<Task>& tasks) {
    std::vector<TopCell> next;
    std::size_t t = 0;
    for (std::size_t c = 0; c < level.size(); ++c) {
      TopCell below{nullptr, {no_bounds(), level[c].cell.depth + 1, 0}, 0, {}, false};
      TopCell above = below;
      for (; t < tasks.size() && tasks[t].cell == c; ++t) {
        take(tasks[t].below, below);
        take(tasks[t].above, above);
      }
      if (!planes[c].found()) {
        level[c].is_leaf = true;
        subtrees_.push_back(std::move(level[c]));
        continue;
      }
      const Shares shares = share(level[c].cell.budget, below.n, above.n);
      below.cell.budget = shares.below;
      above.cell.budget = shares.above;
      split(*level[c].node, planes[c], below, above);
      place(std::move(below), next);
      place(std::move(above), next);
    }
    return next;
  }

  static void take(const Side& side, TopCell& cell) {
    for (const Piece& piece : side.pieces) cell.n += piece.n;
    cell.cell.contents = hull(cell.cell.contents, side.contents);
    cell.pieces.insert(cell.pieces.end(), side.pieces.begin(), side.pieces.end());
  }

  static void split(TopNode& node, const Plane& plane, TopCell& below, TopCell& above) {
    node.axis = plane.axis;
    node.position = plane.position;
    node.below = std::make_unique<TopNode>();
    node.above = std::make_unique<TopNode>();
    below.node = node.below.get();
    above.node = node.above.get();
  }

  // Builds the largest first, so that no thread is left alone with one at the end.
  void build_subtrees() {
    std::stable_sort(subtrees_.begin(), subtrees_.end(),
                     [](const TopCell& a, const TopCell& b) { return a.n > b.n; });
    std::atomic<std::size_t> next{0};
    tbb::parallel_for(0, tbb::this_task_arena::max_concurrency(), [&](int) {
      for (std::size_t i; (i = next++) < subtrees_.size();) build_one(subtrees_[i]);
    });
  }

  void make_leaf(TopCell& top) const {
    RawVector<BoundedRef> refs(top.n);
    auto to = refs.begin();
    for (const Piece& piece : top.pieces) to = std::copy_n(piece.first, piece.n, to);
    append_cell({refs.data(), top.n}, top.cell.contents, top.cell.depth, config_, top.node->fragment);
  }

  void build_one(TopCell& top) {
    if (top.is_leaf) return make_leaf(top);
    Workspace& workspace = workspaces_.local();
    std::vector<BoundedRef>& stack = workspace.stack;
    if (stack.size() < top.n + 1) stack.resize(top.n + 1);
    auto to = stack.begin();
    for (const Piece& piece : top.pieces) to = std::copy_n(piece.first, piece.n, to);
    build_subtree(geometry_, config_, max_depth_, top.n, top.cell, workspace);
    top.node->fragment = workspace.fragment;
  }

  const scene::Geometry& geometry_;
  const BuildConfig& config_;
  const int max_depth_;
  const std::size_t subtree_refs_;
  PiecePool pool_;
  std::vector<TopCell> subtrees_;
  tbb::enumerable_thread_specific<Workspace> workspaces_;
};

}  // namespace

std::unique_ptr<TopNode> build_binned(const scene::Geometry& geometry, const BuildConfig& config,
                                      int max_depth, Bounds& bounds) {
  return TopBuilder(geometry, config, max_depth).run(bounds);
}

}  // namespace kdray::kdtree::binned
