// What    The texts that the page is sent: of a scene, of a frame, of what was picked, of what went wrong.
// Shape   JSON objects with a "type".
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "apps/view/message.h"
#include "apps/view/pick.h"
#include "apps/view/scene_renderer.h"
#include "base/box.h"
#include "kdray/kdray.h"

namespace kdray::view {

// `again`: the scene was opened anew, since a file has changed; the page keeps its camera.
std::string scene_message(std::span<const SceneSource> sources, std::size_t number,
                          const SceneRenderer& renderer, const Settings& settings, bool again);

struct FrameFacts {
  std::uint32_t frame = 0, look = 0;
  int width = 0, height = 0;
  const char* kind = "moving";  // "moving", "rough", "full" (as the PNG that is to follow), "final" (the PNG)
  const char* type = "image/jpeg";
  double encode_seconds = 0, wall_seconds = 0;
  std::string command = {};  // of the final picture
  const Statistics* statistics = nullptr;
};
std::string frame_message(const FrameFacts& facts);

std::string picked_message(std::uint32_t number, const std::optional<Picked>& picked,
                           const PreparedScene& scene);
std::string cells_message(std::size_t scene, int depth, const std::vector<DBox>& cells);
// `about`: "scene" (it can't be opened), "look", "pick".
std::string problem_message(const std::string& about, const std::string& what);
std::string busy_message(const std::string& what);  // empty: not any more

}  // namespace kdray::view
