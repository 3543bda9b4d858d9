#include "apps/cli/sequence.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cctype>
#include <chrono>
#include <exception>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <optional>
#include <sstream>
#include <system_error>
#include <thread>

#include "accel/flatten/frame.h"
#include "apps/cli/camera_path.h"
#include "apps/cli/output.h"
#include "base/error.h"
#include "base/hash.h"
#include "engine/checkpoint/leases.h"
#include "scene/model/frame.h"
#include "scene/model/scene.h"

namespace kdray::cli {

namespace {

namespace fs = std::filesystem;

struct Place {  // of a number in a name
  std::size_t first = 0, end = 0, digits = 0;
};

// Finds "%d", "%4d" or "%04d" in the name; the last one, since folders may have such names too.
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

// Returns the name with a place for a number in it, which numbered() would have inserted.
std::string pattern_of(const std::string& name) {
  if (place_in(name)) return name;
  fs::path path = name;
  path.replace_filename(path.stem().string() + "%04d" + path.extension().string());
  return path.string();
}

bool is_numbered(const RenderArgs& o) {
  return place_in(o.scene.file).has_value();
}

void check_sequence(const RenderArgs& o) {
  const auto refuse = [](const std::string& what) { throw Error(ErrorCode::usage, what); };
  const bool turns = o.checkpoint.turntable > 0;
  if (o.checkpoint.camera_path.empty() && !is_numbered(o) && !o.checkpoint.fps && !turns)
    refuse(
        "all frames would be the same picture: add --camera-path FILE or --turntable N, or number the scenes "
        "(scene%04d.nff), or play a glTF file's animation with --fps N");
  if (turns && is_numbered(o)) refuse("--turntable turns one model; name one file");
  if (o.scene.is_stdin() || o.output == "-" || o.stats == "-")
    refuse("a sequence has a file for each frame; standard input and output have room for one");
  if (!o.output.empty() && !o.write.format) image::format_for_writing(o.output);  // before it is numbered
  const View& v = o.view.view;
  if (!o.checkpoint.camera_path.empty() && (v.camera || v.from || v.at || v.up || v.side || v.fov))
    refuse(
        "--camera-path says where the camera is; leave --from, --at, --up, --view, --fov and --camera out");
}

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
  if (is_numbered(o) || o.checkpoint.fps) add("--frames from", fmt::format("{}", o.checkpoint.frames->first));
  add("--size", fmt::format("{}x{}", r.width, r.height));
  if (r.crop) add("--crop", flatten::in_words(*r.crop));
  add("--samples",
      r.adaptive_target > 0 ? fmt::format("adaptive:{}", r.adaptive_target) : fmt::format("{}", r.samples));
  add("--depth", fmt::format("{}", r.depth));
  add("--min-weight", fmt::format("{}", r.min_weight));
  add("--grid", fmt::format("{}", static_cast<int>(r.grid)));
  add("--precision", fmt::format("{}", static_cast<int>(r.precision)));
  add("--camera-path", hash_of_file(o.checkpoint.camera_path));
  if (o.checkpoint.turntable > 0) add("--turntable", fmt::format("{}", o.checkpoint.turntable));
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
  add("--view", in_text(v.side));
  add("--fov", in_text(v.fov));
  add("--ortho", in_text(v.ortho_width));
  add("--aperture", in_text(v.aperture));
  add("--focus", in_text(v.focus));
  add("--look", in_text(o.view.look ? std::optional(static_cast<int>(*o.view.look)) : std::nullopt));
  add("--smooth", in_text(load.smooth_degrees));
  add("--background", o.view.transparent ? "transparent" : in_text(v.background));
  add("--headlight", fmt::format("{}", v.headlight));
  return text;
}

// Returns the first line in which they differ: there, and here.
std::string difference(const std::string& there, const std::string& here) {
  std::istringstream a(there), b(here);
  std::string line_a, line_b;
  while (std::getline(a, line_a) && std::getline(b, line_b))
    if (line_a != line_b) return fmt::format(" ({}; here {})", line_a, line_b);
  return {};
}

// All processes that share a sequence, and all runs that go on from it, have to make the same frames: a frame
// that is done is not looked at again, so that its own checkpoint can't tell. DIR/sequence.ledger, made once,
// has what was asked for and has a say in the pictures, a line for each. The scene itself is checked by the
// checkpoint of each frame that is rendered. Throws ErrorCode::input, in a line that says which setting
// differs.
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

std::string name_of_picture(const RenderArgs& o, const std::string& scene) {
  if (!o.output.empty()) return o.output;
  return default_picture(scene, o.write.format.value_or(image::PictureFormat::png)).string();
}

// Returns the arguments of one frame.
RenderArgs args_of(const RenderArgs& o, int number) {
  RenderArgs frame = o;
  frame.scene.file = numbered(o.scene.file, number, false);
  frame.output = name_of_picture(o, frame.scene.file);
  if (!o.output.empty() || !is_numbered(o)) frame.output = numbered(frame.output, number, true);
  if (!o.stats.empty()) frame.stats = numbered(o.stats, number, true);
  if (!o.timeline.empty()) frame.timeline = numbered(o.timeline, number, true);
  if (o.checkpoint.fps) frame.scene.load.time = o.scene.load.time.value_or(0) + number / *o.checkpoint.fps;
  frame.render.ledger =
      o.checkpoint.options(fs::path(o.checkpoint.folder()) / fmt::format("frame-{}", number));
  return frame;
}

class Sequence {
 public:
  explicit Sequence(const RenderArgs& o) : o_(o), range_(*o.checkpoint.frames) {
    if (!o.checkpoint.camera_path.empty()) path_.emplace(o.checkpoint.camera_path);
    for (int number = range_.first; path_ && number <= range_.last; ++number)
      static_cast<void>(path_->at(number));  // refuses what is no camera
  }

  int render() {
    if (o_.checkpoint.share.empty())
      for (int number = range_.first; number <= range_.last; ++number) make(number);
    else
      render_shared();
    return 0;
  }

  // Of the pictures: H.264 wants sides that 2 divides.
  bool has_odd_side() const { return maker_ && maker_->has_odd_side(); }

 private:
  void make(int number);
  void find_first(int number);
  const scene::Scene& first() const;
  void tell_of_movement(int number);
  void render_shared();
  void make_what_is_missing();

  const RenderArgs& o_;
  FrameRange range_;
  std::optional<CameraPath> path_;
  std::optional<FrameMaker> maker_;
  SceneInput opened_;  // what the maker has
  // Of several scenes: the first frame that shows anything, from which the others take over, or why it can't
  // be read.
  std::optional<scene::Scene> first_;
  int first_number_ = range_.first;
  std::exception_ptr fault_;
  bool has_told_ = false;
};

void Sequence::make(int number) {
  RenderArgs frame = args_of(o_, number);
  if (!maker_ || opened_.file != frame.scene.file || !(opened_.load == frame.scene.load)) {
    maker_.reset();
    const bool is_further = number != range_.first && (is_numbered(o_) || o_.checkpoint.fps);
    if (is_further) find_first(number);
    const FrameMaker::First first = [this]() -> const scene::Scene& { return this->first(); };
    const bool takes_over = fault_ || (first_ && number > first_number_);
    maker_.emplace(frame, takes_over ? first : FrameMaker::First());
    opened_ = frame.scene;
    if (!first_ && !fault_ && first_number_ == number) {
      if (maker_->box().empty())
        ++first_number_;
      else
        first_ = maker_->seen().settings();
    }
    if (takes_over) tell_of_movement(number);
  }
  if (path_) frame.render.camera = path_->at(number, maker_->own_camera());
  if (o_.checkpoint.turntable > 0) maker_->turn(frame, static_cast<double>(number) / o_.checkpoint.turntable);
  maker_->make(frame);
}

// Finds the first frame before `number` that shows anything, where another process has made it, or a run
// before. One that can't be read is an error for frames that lack what they would take over.
void Sequence::find_first(int number) {
  for (; !first_ && !fault_ && first_number_ < number; ++first_number_) {
    RenderArgs frame = args_of(o_, first_number_);
    frame.quiet = true;
    try {
      const FrameMaker maker(frame);
      if (maker.box().empty()) continue;
      first_ = maker.seen().settings();
      return;
    } catch (const Error&) {
      fault_ = std::current_exception();
    }
  }
}

const scene::Scene& Sequence::first() const {
  if (fault_) std::rethrow_exception(fault_);
  return *first_;
}

void Sequence::tell_of_movement(int number) {
  if (o_.quiet || has_told_ || !first_ || !first_->framing.camera || o_.view.view.from || path_) return;
  const DBox &there = first_->framing.box, &here = maker_->box();
  const dvec3 margin = 0.5 * there.extent();
  if (here.empty() || (scene::contains({there.lo - margin, there.hi + margin}, here.lo) &&
                       scene::contains({there.lo - margin, there.hi + margin}, here.hi)))
    return;
  has_told_ = true;
  say(
      fmt::format("frame {} reaches beyond what the view of frame {} is made for; --from and --at say where "
                  "to look from",
                  number, first_number_));
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
  // Processes that join others spread over the frames that are in work.
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

// Makes the pictures that were made elsewhere, or removed; at least one, which shows whether the checkpoint
// is this run's at all.
void Sequence::make_what_is_missing() {
  const auto is_there = [&](int number) { return fs::exists(args_of(o_, number).output); };
  for (int number = range_.first; number <= range_.last; ++number)
    if (!is_there(number) || (number == range_.last && !maker_)) make(number);
}

}  // namespace

namespace {

// As a shell takes it for one word.
std::string quoted(const std::string& name) {
  std::string text = "'";
  for (const char c : name) text += c == '\'' ? "'\\''" : std::string(1, c);
  return text + "'";
}

// Returns the name as ffmpeg has it, to which another % than that of the number is a %%.
std::string pattern_of_ffmpeg(const std::string& pattern) {
  const std::optional<Place> place = place_in(pattern);
  std::string text;
  for (std::size_t i = 0; i < pattern.size(); ++i)
    text += pattern[i] == '%' && !(place && i == place->first) ? "%%" : pattern.substr(i, 1);
  return text;
}

void tell_of_film(const RenderArgs& o, bool has_odd_side) {
  const fs::path pictures = pattern_of(name_of_picture(o, o.scene.file));
  if (ending_of(pictures) != ".png") return;
  const fs::path film = default_picture(o.scene.file).replace_extension(".mp4");
  say(fmt::format("a film of it: ffmpeg -framerate 24 -start_number {} -i {} {}-pix_fmt yuv420p {}",
                  o.checkpoint.frames->first, quoted(pattern_of_ffmpeg(pictures)),
                  has_odd_side ? "-vf 'pad=ceil(iw/2)*2:ceil(ih/2)*2' " : "", quoted(film)));
}

}  // namespace

std::string numbered(const std::string& name, int number, bool insert) {
  const std::string pattern = insert ? pattern_of(name) : name;
  const std::optional<Place> place = place_in(pattern);
  if (!place) return name;
  return pattern.substr(0, place->first) + fmt::format("{:0{}}", number, place->digits) +
         pattern.substr(place->end);
}

void check_checkpoint(const RenderArgs& o) {
  o.checkpoint.check();
  if (o.checkpoint.restarts > 0 && o.scene.is_stdin())
    throw Error(ErrorCode::usage, "--restarts can't read a scene from standard input again; name a file");
  if (o.checkpoint.frames) check_sequence(o);
}

int render_sequence(const RenderArgs& o) {
  Sequence sequence(o);
  const int code = sequence.render();
  if (o.checkpoint.turntable > 0 && !o.quiet) tell_of_film(o, sequence.has_odd_side());
  return code;
}

}  // namespace kdray::cli
