#include "apps/cli/sequence_settings.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <chrono>
#include <fstream>
#include <iterator>
#include <sstream>
#include <thread>

#include "base/error.h"
#include "base/hash.h"
#include "engine/checkpoint/create_once.h"

namespace kdray::cli {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostBytes = 1 << 16;

template <class T>
std::string in_text(const std::optional<T>& value) {
  return value ? fmt::format("{}", *value) : "the scene's";
}

std::string hash_of_file(const std::string& name) {
  if (name.empty()) return "none";
  std::ifstream stream(name, std::ios::binary);
  return in_hex(hash_of(std::string{std::istreambuf_iterator<char>(stream), {}}));
}

std::string settings_of(const RenderArgs& o) {
  const RenderOptions& r = o.render;
  const View& v = o.view.view;
  std::string text = "kdray sequence 1\n";
  const auto add = [&text](const char* name, const std::string& value) {
    text += fmt::format("{} {}\n", name, value);
  };
  add("scene", fs::path(o.scene.file).filename().string());
  add("--size", fmt::format("{}x{}", r.width, r.height));
  add("--samples",
      r.adaptive_target > 0 ? fmt::format("adaptive:{}", r.adaptive_target) : fmt::format("{}", r.samples));
  add("--depth", fmt::format("{}", r.depth));
  add("--min-weight", fmt::format("{}", r.min_weight));
  add("--grid", fmt::format("{}", static_cast<int>(r.grid)));
  add("--precision", fmt::format("{}", static_cast<int>(r.precision)));
  add("--camera-path", hash_of_file(o.checkpoint.camera_path));
  const LoadOptions& load = o.scene.load;
  if (o.checkpoint.fps || load.time) {
    add("--fps", in_text(o.checkpoint.fps));
    add("--time", in_text(load.time));
    add("--animation", load.animation);
  }
  add("--camera", in_text(v.camera));
  add("--from", in_text(v.from));
  add("--at", in_text(v.at));
  add("--up", in_text(v.up));
  add("--fov", in_text(v.fov));
  add("--ortho", in_text(v.ortho_width));
  add("--aperture", in_text(v.aperture));
  add("--focus", in_text(v.focus));
  add("--background", o.view.transparent ? "transparent" : in_text(v.background));
  add("--headlight", fmt::format("{}", v.headlight));
  return text;
}

// The first line in which they differ: there, and here.
std::string difference(const std::string& there, const std::string& here) {
  std::istringstream a(there), b(here);
  std::string line_a, line_b;
  while (std::getline(a, line_a) && std::getline(b, line_b))
    if (line_a != line_b) return fmt::format(" ({}; here {})", line_a, line_b);
  return {};
}

}  // namespace

void check_sequence_settings(const RenderArgs& o, const fs::path& folder) {
  const fs::path file = folder / "sequence.ledger";
  const std::string here = settings_of(o);
  if (checkpoint::create_once(file, here)) return;
  std::string there = checkpoint::read_small(file, kMostBytes);
  for (int i = 0; there.empty() && i < 20;
       ++i) {  // where it is made without a link, it may be a moment until it is whole
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    there = checkpoint::read_small(file, kMostBytes);
  }
  if (there != here)
    throw input_error(folder.string(), 0,
                      "the frames in this folder are of other settings" + difference(there, here),
                      "name another folder, or remove this one");
}

}  // namespace kdray::cli
