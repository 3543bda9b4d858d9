// What    The messages that the page is sent: texts of a scene, of a frame, of what was picked, of what went
//         wrong; and a picture on its way to a page.
// Shape   A text is a JSON object with a "type". A picture is one message of bytes: four with the length of
//         the text about it (little endian), the text, the picture's file.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "apps/view/message.h"
#include "apps/view/pick.h"
#include "apps/view/scene_renderer.h"
#include "apps/view/server.h"
#include "base/box.h"
#include "kdray/kdray.h"

namespace kdray::view {

// `again`: the scene was opened anew, since a file has changed; the page keeps its camera.
std::string scene_message(std::span<const SceneSource> sources, std::size_t number,
                          const SceneRenderer& renderer, bool again);

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

Bytes make_frame(std::string_view head, std::string_view picture);

}  // namespace kdray::view
