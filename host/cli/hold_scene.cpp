#include "cli/hold_scene.h"

#include <string>
#include <utility>

#include "cli/message.h"
#include "cli/ranks.h"
#include "distribute/holding.h"

namespace kdray::cli {

namespace {

void say_whole(const std::string& why, bool quiet) {
  if (!quiet) say("every rank holds the whole scene: " + why);
}

}  // namespace

bool holds_shares(const RenderArgs& o) {
  if (!ranks_of_this_run() || o.render.mode != Mode::odprt) return false;
  const bool channels = !o.render.channels.empty();
  if (channels) say_whole("--aov needs it", o.quiet);
  if (o.view.transparent) say_whole("--background transparent needs it", o.quiet);
  return !channels && !o.view.transparent && !o.tree.binary_form;  // what needs that, ODPRT refuses
}

std::optional<SceneHeld> hold_scene(const SceneInput& input, const TreeOptions& tree, bool quiet,
                                    const std::function<void(const scene::Scene&)>& check) {
  const std::shared_ptr<transport::Together> all = together_of_this_run();
  std::optional<distribute::Holding> holding = distribute::hold(input.file, input.load, tree, *all, check);
  if (!holding) {
    say_whole("one with instances isn't divided", quiet);
    return std::nullopt;
  }
  return SceneHeld{std::move(holding->prepared),
                   std::make_shared<const api::Held>(api::Held{holding->core, holding->primitives, all})};
}

}  // namespace kdray::cli
