#include "apps/cli/sequence.h"

#include <fmt/format.h>

#include <cctype>
#include <chrono>
#include <filesystem>
#include <functional>
#include <optional>
#include <system_error>
#include <thread>

#include "apps/cli/camera_path.h"
#include "apps/cli/message.h"
#include "apps/cli/output.h"
#include "apps/cli/sequence_settings.h"
#include "base/error.h"
#include "engine/checkpoint/create_once.h"
#include "engine/checkpoint/leases.h"

namespace kdray::cli {

namespace {

namespace fs = std::filesystem;

struct Place {  // of a number in a name
  std::size_t first = 0, end = 0, digits = 0;
};

// "%d", "%4d" or "%04d"; the last one, since folders may have such names too.
std::optional<Place> place_in(const std::string& name) {
  for (std::size_t at = name.rfind('%'); at != std::string::npos;
       at = at == 0 ? std::string::npos : name.rfind('%', at - 1)) {
    std::size_t end = at + 1;
    while (end < name.size() && std::isdigit(static_cast<unsigned char>(name[end])) != 0 && end - at < 4)
      ++end;
    if (end == name.size() || name[end] != 'd') continue;
    const std::string digits = name.substr(at + 1, end - at - 1);
    return Place{at, end + 1, digits.empty() ? 1 : static_cast<std::size_t>(std::stoi(digits))};
  }
  return std::nullopt;
}

bool is_numbered(const RenderArgs& o) {
  return place_in(o.scene.file).has_value();
}

void check_sequence(const RenderArgs& o) {
  const auto refuse = [](const std::string& what) { throw Error(ErrorCode::usage, what); };
  if (o.checkpoint.camera_path.empty() && !is_numbered(o) && !o.checkpoint.fps)
    refuse(
        "all frames would be the same picture: add --camera-path FILE, or number the scenes (scene%04d.nff), "
        "or "
        "play a glTF file's animation with --fps N");
  if (o.scene.is_stdin() || o.output == "-" || o.stats == "-")
    refuse("a sequence has a file for each frame; standard input and output have room for one");
  const View& v = o.view.view;
  if (!o.checkpoint.camera_path.empty() && (v.camera || v.from || v.at || v.up || v.fov || v.ortho_width))
    refuse(
        "--camera-path says where the camera is; leave --from, --at, --up, --fov, --camera and --ortho out");
}

// What is to be done for one frame.
RenderArgs args_of(const RenderArgs& o, const std::optional<CameraPath>& path, int number) {
  RenderArgs frame = o;
  frame.scene.file = numbered(o.scene.file, number, false);
  if (o.output.empty()) {
    const fs::path name =
        default_picture(frame.scene.file, o.write.format.value_or(image::PictureFormat::png));
    frame.output = is_numbered(o) ? name.string() : numbered(name.string(), number, true);
  } else {
    frame.output = numbered(o.output, number, true);
  }
  if (!o.stats.empty()) frame.stats = numbered(o.stats, number, true);
  if (!o.timeline.empty()) frame.timeline = numbered(o.timeline, number, true);
  if (path) frame.render.camera = path->at(number);
  if (o.checkpoint.fps) frame.scene.load.time = o.scene.load.time.value_or(0) + number / *o.checkpoint.fps;
  frame.render.ledger =
      o.checkpoint.options(fs::path(o.checkpoint.folder()) / fmt::format("frame-{}", number));
  return frame;
}

class Sequence {
 public:
  explicit Sequence(const RenderArgs& o) : o_(o), range_(*o.checkpoint.frames) {
    if (!o.checkpoint.camera_path.empty()) path_.emplace(o.checkpoint.camera_path);
  }

  int render() {
    if (o_.checkpoint.share.empty())
      for (int number = range_.first; number <= range_.last; ++number) make(number);
    else
      render_shared();
    return 0;
  }

 private:
  void make(int number);
  void render_shared();
  void make_what_is_missing();

  const RenderArgs& o_;
  FrameRange range_;
  std::optional<CameraPath> path_;
  std::optional<FrameMaker> maker_;
  SceneInput opened_;  // what the maker has
};

void Sequence::make(int number) {
  RenderArgs frame = args_of(o_, path_, number);
  if (!maker_ || opened_.file != frame.scene.file || !(opened_.load == frame.scene.load)) {
    maker_.reset();
    maker_.emplace(frame);
    opened_ = frame.scene;
  }
  maker_->make(frame);
}

void Sequence::render_shared() {
  const LedgerOptions options = *o_.checkpoint.options();
  std::error_code error;
  fs::create_directories(options.folder, error);
  check_sequence_settings(o_, options.folder);
  checkpoint::Heartbeat heartbeat(options.folder, checkpoint::new_owner(), options.lease_seconds);
  const auto first = static_cast<std::size_t>(range_.first),
             n = static_cast<std::size_t>(range_.last) - first + 1;
  checkpoint::Leases frames(options.folder, "frame", first, n, heartbeat);
  // Processes that join others spread over what is in work.
  std::size_t join = std::hash<std::string>()(heartbeat.owner()) % n;
  const auto find = [&](std::size_t from, const auto& is_it) {
    for (std::size_t k = 0; k < n; ++k)
      if (is_it((from + k) % n)) return (from + k) % n;
    return n;
  };
  for (frames.look(); !frames.all_done(); frames.look()) {
    std::size_t i = find(0, [&](std::size_t f) { return frames.is_free(f); });
    if (i == n)
      i = join = find(join, [&](std::size_t f) { return !frames.is_done(f); });
    else if (!frames.claim(i))
      continue;
    make(range_.first + static_cast<int>(i));
    frames.finish(i);
  }
  make_what_is_missing();
}

// Pictures that were made elsewhere, or removed. One at least, which tells whether the checkpoint is this
// run's at all.
void Sequence::make_what_is_missing() {
  const auto is_there = [&](int number) { return fs::exists(args_of(o_, path_, number).output); };
  for (int number = range_.first; number <= range_.last; ++number)
    if (!is_there(number) || (number == range_.last && !maker_)) make(number);
}

}  // namespace

std::string numbered(const std::string& name, int number, bool insert) {
  if (const std::optional<Place> place = place_in(name))
    return name.substr(0, place->first) + fmt::format("{:0{}}", number, place->digits) +
           name.substr(place->end);
  if (!insert) return name;
  fs::path path = name;
  path.replace_filename(path.stem().string() + fmt::format("{:04}", number) + path.extension().string());
  return path.string();
}

void check_checkpoint(const RenderArgs& o) {
  o.checkpoint.check();
  if (o.checkpoint.restarts > 0 && o.scene.is_stdin())
    throw Error(ErrorCode::usage, "--restarts can't read a scene from standard input again; name a file");
  if (o.checkpoint.frames) check_sequence(o);
}

int render_sequence(const RenderArgs& o) {
  return Sequence(o).render();
}

}  // namespace kdray::cli
