#include "apps/cli/partition_scene.h"

#include <cstdint>
#include <filesystem>
#include <string>
#include <system_error>
#include <utility>

#include "apps/cli/message.h"
#include "apps/cli/ranks.h"
#include "cluster/partition/scene_partition.h"

namespace kdray::cli {

namespace {

constexpr std::uintmax_t kLargeFile = std::uintmax_t{64} << 20;

// Of a small scene all can have all: rays travel less where the costs of the whole are known, and what most
// of them come to is held by every rank. Ranks that see other files do the same, too.
bool wants_shares(const RenderArgs& o) {
  if (o.hold != "auto") return o.hold == "shares";
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(o.scene.file, error);
  return together_of_this_run()->any(!error && size >= kLargeFile);
}

void say_whole(const std::string& why, bool quiet) {
  if (!quiet) say("every rank holds the whole scene: " + why);
}

}  // namespace

bool holds_shares(const RenderArgs& o) {
  if (!ranks_of_this_run() || o.render.mode != Mode::odprt) return false;
  if (!wants_shares(o)) return false;
  if (!o.render.channels.empty()) say_whole("--aov needs it", o.quiet);
  if (o.view.transparent) say_whole("--background transparent needs it", o.quiet);
  const bool needs_whole = !o.render.channels.empty() || o.view.transparent;
  return !needs_whole && !o.tree.binary_form;  // what needs that, ODPRT refuses
}

std::optional<PartitionedScene> partition_scene(const SceneInput& input, const TreeOptions& tree, bool quiet,
                                                const std::function<void(const scene::Scene&)>& check) {
  const std::shared_ptr<transport::Together> all = together_of_this_run();
  std::optional<partition::ScenePartition> own =
      partition::partition_scene(input.file, input.load, tree, *all, check);
  if (!own) {
    say_whole("one with instances isn't divided", quiet);
    return std::nullopt;
  }
  return PartitionedScene{std::move(own->prepared), std::make_shared<const api::WholeScene>(
                                                        api::WholeScene{own->core, own->primitives, all})};
}

}  // namespace kdray::cli
