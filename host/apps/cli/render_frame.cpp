#include "apps/cli/render_frame.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "accel/flatten/frame.h"
#include "apps/cli/memory.h"
#include "apps/cli/output.h"
#include "apps/cli/progress.h"
#include "apps/cli/ranks.h"
#include "apps/cli/stats.h"
#include "apps/cli/summary.h"
#include "base/process_memory.h"
#include "scene/model/frame.h"
#include "scene/model/scene.h"

namespace kdray::cli {

namespace {

namespace fs = std::filesystem;

// Checks files before the scene is read. A picture's name that isn't given depends on the files that the
// scene names.
void check_files(const RenderArgs& o, RunFiles& files) {
  check_scene_input(o.scene);
  if (o.view.transparent && o.render.adaptive_target > 0)
    throw Error(ErrorCode::usage,
                "--background transparent needs a number of --samples; adaptive ones don't look at coverage");
  files.read("SCENE", o.scene.file);
  files.write_picture("--output", o.output, o.render.channels, o.write);
  files.write("--stats", o.stats);
  files.write("--trace", o.timeline);
}

fs::path default_output(const RenderArgs& o) {
  return default_picture(o.scene.file, o.write.format.value_or(image::PictureFormat::png));
}

// Checks files once it is known which ones the scene names.
void check_files(RenderArgs& o, RunFiles& files, const scene::Scene& asked) {
  files.read_scene(asked.files);
  if (!o.output.empty()) return;
  const fs::path usual = default_output(o);
  o.output = files.free_name(usual, o.render.channels, o.write).string();
  files.write_picture("--output", o.output, o.render.channels, o.write);
  if (o.output != usual && !o.quiet)
    say(fmt::format("{} is a file that the scene names: the picture goes to {}", usual.string(), o.output));
}

bool makes_exr(const RenderArgs& o) {
  return o.write.format ? *o.write.format == image::PictureFormat::exr : ending_of(o.output) == ".exr";
}

void tell_of_options_without_effect(const RenderArgs& o) {
  if (o.quiet || !makes_exr(o)) return;
  for (const auto& [name, given] : {std::pair("--gamma", o.gamma_given), {"--exposure", o.exposure_given}})
    if (given) say(fmt::format("{} has no effect: an EXR holds linear values", name));
  if (o.bits_given) say("--bits has no effect: an EXR holds floats");
}

// The size is resolved as the renderer will do it (RenderOptions::width).
void check_memory(const RenderArgs& o, scene::RenderSettings asked) {
  const RenderOptions& render = flatten::resolved(o.render, asked);  // refuses a part that isn't in it
  PictureNeeds picture{.width = static_cast<std::uint64_t>(render.width),
                       .height = static_cast<std::uint64_t>(render.height)};
  if (render.crop) {
    picture.width = static_cast<std::uint64_t>(render.crop->width);
    picture.height = static_cast<std::uint64_t>(render.crop->height);
  }
  for (const std::string& name : render.channels) picture.n_channels += name == "normal" ? 3 : 1;
  if (o.view.transparent) picture.n_channels += 4;  // alpha, and what it or a sky comes from
  picture.exr = makes_exr(o);
  picture.bits = o.write.png_bits;
  picture.adaptive = render.adaptive_target > 0;
  picture.n_queues = static_cast<std::uint64_t>(o.device.queues);
  check_picture_fits(picture, free_memory());
}

// Returns what the picture's own eye rays alone see of the scene.
std::vector<float> eye_rays_picture(const PreparedScene& scene, const DeviceOptions& device,
                                    const RenderOptions& render) {
  RenderOptions options = render;
  options.depth = 1;
  options.channels.clear();
  options.progress = {};
  options.timeline = false;
  options.ledger.reset();
  return Renderer(scene, device).render(options).rgb;
}

// Returns the picture's alpha, where it is wanted, and takes the background out of its colours then: what eye
// rays that hit nothing have brought.
std::vector<float> make_transparent(Picture& picture, const PreparedScene& scene, const DeviceOptions& device,
                                    const RenderArgs& o) {
  if (!o.view.transparent) return {};
  std::vector<float> alpha;
  {
    const std::vector<float> white = eye_rays_picture(scene.coverage(), device, o.render);
    for (std::size_t i = 0; i < white.size(); i += 3) alpha.push_back(std::clamp(white[i], 0.0f, 1.0f));
  }
  const bool has_sky = scene.settings().sky.kind != scene::SkyKind::none;
  const std::vector<float> sky =
      has_sky ? eye_rays_picture(scene.backdrop(), device, o.render) : std::vector<float>();
  const vec3& background = scene.settings().background;
  for (std::size_t i = 0; i < picture.rgb.size(); ++i) {
    const float covered = alpha[i / 3];
    float& value = picture.rgb[i];
    // Where nothing is covered nothing may be left, however the sum was rounded.
    value = covered == 0 ? 0 : std::max(0.0f, value - (has_sky ? sky[i] : (1 - covered) * background[i % 3]));
  }
  return alpha;
}

image::Image to_image(const Picture& picture) {
  image::Image image{.width = picture.width,
                     .height = picture.height,
                     .pixels = std::vector<vec3>(picture.rgb.size() / 3),
                     .x = picture.x,
                     .y = picture.y,
                     .whole_width = picture.whole_width,
                     .whole_height = picture.whole_height};
  static_assert(sizeof(vec3) == 3 * sizeof(float));
  std::memcpy(image.pixels.data(), picture.rgb.data(), image.pixels.size() * sizeof(vec3));
  return image;
}

// Returns by each name the numbers that have it, as pairs of the first and how many follow each other.
std::string manifest_of(const scene::Names& names, const std::vector<scene::NameRun>& runs) {
  Json manifest = Json::object();
  for (std::size_t i = 0; i + 1 < runs.size(); ++i)
    if (const std::string name(names.text(runs[i].name)); !name.empty())
      manifest[name].push_back({runs[i].first, runs[i + 1].first - runs[i].first});
  return manifest.empty() ? std::string() : manifest.dump(-1, ' ', false, Json::error_handler_t::replace);
}

image::Written write(Picture&& picture, std::vector<float>&& alpha, const scene::Names* names,
                     const RenderArgs& o) {
  std::vector<image::Channel> channels;
  for (Channel& c : picture.channels) {
    channels.push_back({std::move(c.name), std::move(c.values)});
    image::Channel& made = channels.back();
    if (names && made.name == "primitive") made.manifest = manifest_of(*names, names->primitives);
    if (names && made.name == "instance") made.manifest = manifest_of(*names, names->instances);
  }
  image::Image image = to_image(picture);
  image.alpha = std::move(alpha);
  picture.rgb = {};  // large pictures: no third copy while the file is made
  return put_picture(o.output, image, channels, o.write);
}

// Rank 0 puts the scene into the cache first, where the others find it, if they see the same folder.
void wait_for_scene() {
  if (!leads()) ranks_of_this_run()->wait(transport::kTagsOfScenes);
}

void tell_of_scene(OpenedScene& scene) {
  if (!ranks_of_this_run() || !leads()) return;
  scene.keep_scene();
  ranks_of_this_run()->send_to_others(transport::kTagsOfScenes.first, {});
}

// A background that becomes transparent is one colour, in a studio too. `first`: it is a further frame of a
// film.
PreparedScene seen_by(View view, const PreparedScene& shown, const RenderArgs& o,
                      const FrameMaker::First& first = {}) {
  const scene::Framing& framing = shown.settings().framing;
  const bool in_studio = framing.studio.has_value();
  if (in_studio && o.view.transparent && shown.settings().sky.kind == scene::SkyKind::none)
    view.background = {0, 0, 0};  // in place of the studio's backdrop
  const bool takes_over =
      framing.camera || framing.lights || framing.illuminance > 0 || view.side || view.ortho_width == 0.0;
  if (first && takes_over) return shown.seen_after(first(), view, o.render.width, o.render.height);
  return in_studio || o.view.any || view.from ? shown.seen(view, o.render.width, o.render.height) : shown;
}

// No rank knows the shape of a scene that is held in shares, by which a studio is furnished.
void take_plain_look(RenderArgs& o, const scene::Scene& scene, bool is_further) {
  if (!o.view.look && !is_further && scene.framing.camera && scene.framing.lights && leads() && !o.quiet)
    say("in the plain look, as ranks hold shares of the scene; --hold whole --look studio for the other");
  o.view.look = Look::plain;
}

}  // namespace

FrameMaker::FrameMaker(RenderArgs& o, const First& first) : is_further_(first != nullptr) {
  if (leads()) check_files(o, files_);
  if (const auto ledger = o.checkpoint.options(); ledger && leads())
    files_.write_folder(o.checkpoint.share.empty() ? "--checkpoint" : "--share", ledger->folder);
  tell_of_options_without_effect(o);
  o.tree.binary_form = takes_binary_form(o.render.traversal, o.render.precision, o.render.channels);
  const bool in_shares = holds_shares(o);
  scene_.emplace(
      o.scene, o.tree, o.device, o.cache, o.quiet,
      [&](const scene::Scene& asked) {
        check_view_of(o.view, asked);
        if (leads()) check_files(o, files_, asked);
        check_memory(o, scene::settings_of(asked));
      },
      o.hooks, OpeningByRanks{.in_shares = in_shares, .before_lookup = wait_for_scene});
  if (scene_->cache() != "off") tell_of_scene(*scene_);
  o.hooks.whole = scene_->whole();
  if (in_shares) take_plain_look(o, scene_->scene().settings(), is_further_);
  shown_ = in_look(scene_->scene(), o.view);
  seen_ = seen_by(o.view.view, *shown_, o, first);
  if (o.view.view.focus && o.checkpoint.camera_path.empty() && !is_further_ && !o.quiet && leads() &&
      !(seen_->settings().camera->aperture > 0))
    say("--focus has no effect: there is no lens; --aperture D puts one in");
  renderer_ = api::make_renderer(*seen_, scene_->device(), o.hooks);
}

const DBox& FrameMaker::box() const {
  return shown_->settings().framing.box;
}

void FrameMaker::turn(const RenderArgs& o, double turns) {
  if (!turntable_) {
    const scene::Scene& seen = seen_->settings();
    scene::RenderSettings asked = scene::settings_of(seen);
    scene::set_size(asked, o.render.width, o.render.height);
    turntable_.emplace(seen, o.view.view, scene::aspect_of(asked));
  }
  seen_ = seen_by(turntable_->after(turns), *shown_, o);
  renderer_->look(*seen_);
}

Camera FrameMaker::own_camera() const {
  const auto& own = seen_->settings().camera;
  if (!own) return {};
  return {
      .ortho_width = own->ortho_width, .hither = own->hither, .aperture = own->aperture, .focus = own->focus};
}

Picture FrameMaker::render(const RenderArgs& o) {
  Progress progress(o.quiet);
  RenderOptions options = o.render;
  options.timeline = !o.timeline.empty();
  options.progress = [&progress](double share) { progress.update(share); };
  return renderer_->render(options);
}

void FrameMaker::make(RenderArgs& o) {
  if (!is_first_ && leads()) {
    check_files(o, files_);
    check_files(o, files_, seen_->settings());
  }
  Picture picture = render(o);
  if (!leads()) return;
  has_odd_side_ = picture.width % 2 != 0 || picture.height % 2 != 0;
  std::vector<float> alpha = make_transparent(picture, *seen_, scene_->device(), o);
  if (!o.quiet)
    for (const std::string& warning : picture.warnings) say(warning);
  Statistics figures = renderer_->statistics();
  const Timer step;
  const image::Written written =
      write(std::move(picture), std::move(alpha), seen_->settings().names.get(), o);
  figures.seconds.write = step.seconds();
  if (is_first_ && !is_further_ && !o.quiet && !o.render.camera) tell_of_view(*seen_, o.view);
  if (is_first_) {
    scene_->keep();
    scene_->add_to(figures.seconds);
  }
  const bool is_first = std::exchange(is_first_, false);
  figures.seconds.total = total_.seconds();
  total_.restart();

  Json stats = collect_stats("render", o.scene.file, figures);
  stats["cache"] = scene_->cache();
  for (const auto& file : written.files) stats["files"].push_back(file.string());
  if (!o.stats.empty()) write_stats(o.stats, stats);
  if (!o.timeline.empty()) write_text(o.timeline, renderer_->timeline() + "\n");
  if (!o.quiet) print_render_summary(stats, written.nan_values, o.verbose, is_first);
}

}  // namespace kdray::cli
