#include "apps/view/view_service.h"

#include <algorithm>
#include <new>
#include <utility>

#include "apps/view/scene_renderer.h"
#include "base/timer.h"

namespace kdray::view {

namespace {

using namespace std::chrono_literals;
constexpr auto kCheckEvery = 300ms;    // whether files have changed
constexpr std::size_t kMostJobs = 64;  // that wait for the worker

std::string error_text(std::exception_ptr error) {
  try {
    std::rethrow_exception(std::move(error));
  } catch (const std::bad_alloc&) {
    return "out of memory";
  } catch (const std::exception& e) {
    return e.what();
  }
}

}  // namespace

ViewService::ViewService(std::vector<SceneSource> sources, Settings settings, LoadedScene first)
    : sources_(std::move(sources)),
      settings_(std::move(settings)),
      opening_(sources_.size()),
      worker_(kMostJobs) {
  // Compilers may nest; the page is told of the first that begins and of the last that ends.
  settings_.device.building = [this](bool begins) {
    const int before = compilers_.fetch_add(begins ? 1 : -1);
    if (!begins) compiled_ = true;
    if (before != (begins ? 0 : 1)) return;
    const std::lock_guard lock(mutex_);
    send_to_all(busy_message(begins ? "compiling for what this scene needs" : ""));
  };
  auto renderer = std::make_shared<SceneRenderer>(std::move(first), settings_);
  FileWatcher watcher(renderer->files());
  open_scenes_.emplace(0, OpenScene{std::move(renderer), std::move(watcher)});
  thread_ = std::thread([this] { run(); });
}

ViewService::~ViewService() {
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
    if (cancel_) cancel_->cancel();
  }
  changed_.notify_all();
  thread_.join();
}

// ---- Messages of pages

ViewService::ClientState* ViewService::find_client(const Client& client) {
  const auto found =
      std::ranges::find_if(clients_, [&](const ClientState& s) { return s.client.get() == &client; });
  return found == clients_.end() ? nullptr : &*found;
}

void ViewService::connected(const std::shared_ptr<Client>& client) {
  const std::lock_guard lock(mutex_);
  ClientState& state = clients_.emplace_back();
  state.client = client;
  open_scenes_.contains(0) ? send_scene(state, 0, false) : open(0);
}

void ViewService::disconnected(const Client& client) {
  const std::lock_guard lock(mutex_);
  if (cancel_ && rendered_for_ == &client) cancel_->cancel();
  clients_.remove_if([&](const ClientState& state) { return state.client.get() == &client; });
}

void ViewService::received(const Client& client, const Message& message) {
  const std::lock_guard lock(mutex_);
  ClientState* const state = find_client(client);
  if (state != nullptr) std::visit([&](const auto& m) { handle(*state, m); }, message);
}

// A page that asks for another scene than its last one is sent the message about it first, and takes the
// camera from that.
void ViewService::handle(ClientState& state, const Look& look) {
  const std::size_t scene = look.request.scene;
  if (scene >= sources_.size()) throw Error(ErrorCode::input, "the page's message: there is no such scene");
  if (scene != state.scene || !open_scenes_.contains(scene)) {
    state.scene = scene;
    open_scenes_.contains(scene) ? send_scene(state, scene, false) : open(scene);
    return;
  }
  state.pacer.request(look);
  if (cancel_ && rendered_for_ == state.client.get() && !moving_) cancel_->cancel();
  changed_.notify_all();
}

void ViewService::handle(ClientState& state, const Shown& shown) {
  if (!state.pacer.acknowledge(shown.frame))
    throw Error(ErrorCode::input, "the page's message: there was no such frame");
  changed_.notify_all();
}

void ViewService::handle(ClientState& state, const Pick& pick) {
  const auto found = open_scenes_.find(pick.request.scene);
  if (found == open_scenes_.end()) return;
  worker_.add([client = state.client, renderer = found->second.renderer, pick] {
    try {
      client->send(
          picked_message(pick.number, renderer->pick(pick.request, pick.x, pick.y), renderer->scene()));
    } catch (...) {
      client->send(problem_message("pick", error_text(std::current_exception())));
    }
  });
}

void ViewService::handle(ClientState& state, const Cells& cells) {
  const auto found = open_scenes_.find(cells.scene);
  if (found == open_scenes_.end()) return;
  worker_.add([client = state.client, renderer = found->second.renderer, cells] {
    const auto boxes =
        cells.depth > 0 ? cells_of(renderer->scene().prepared(), cells.depth) : std::vector<DBox>();
    client->send(cells_message(cells.scene, cells.depth, boxes));
  });
}

void ViewService::handle(ClientState&, const Smooth& smooth) {
  if (smooth.scene >= sources_.size() || sources_[smooth.scene].file.empty())
    throw Error(ErrorCode::input, "the page's message: there is no such file");
  smooth_[smooth.scene] = smooth.degrees;
  open_anew(smooth.scene);
}

Settings ViewService::settings_of(std::size_t scene) const {
  Settings settings = settings_;
  if (const auto chosen = smooth_.find(scene); chosen != smooth_.end()) {
    settings.load.smooth_degrees.reset();
    if (chosen->second > 0) settings.load.smooth_degrees = chosen->second;
  }
  return settings;
}

void ViewService::send_scene(ClientState& state, std::size_t scene, bool again) {
  state.scene = scene;
  state.client->send(scene_message(sources_, scene, *open_scenes_.at(scene).renderer, again));
}

void ViewService::send_to_all(const std::string& text, std::optional<std::size_t> scene) {
  for (ClientState& state : clients_)
    if (!scene || state.scene == *scene) state.client->send(text);
}

// ---- Scenes

void ViewService::open_again(std::size_t scene) {
  const std::lock_guard lock(mutex_);
  if (open_scenes_.contains(scene)) open_anew(scene);
}

void ViewService::open_anew(std::size_t scene) {
  if (opening_[scene] == Opening::no)
    open(scene);
  else
    opening_[scene] = Opening::outdated;
}

void ViewService::open(std::size_t scene) {
  if (opening_[scene] != Opening::no) return;
  const bool begins = worker_.add([this, scene, load = settings_of(scene).load] {
    try {
      opened(scene, sources_[scene].open(load));
    } catch (...) {
      not_opened(scene, error_text(std::current_exception()));
    }
  });
  if (!begins)
    return send_to_all(problem_message("scene", "too much is waiting to be done; ask again"), scene);
  opening_[scene] = Opening::now;
  send_to_all(busy_message("opening " + sources_[scene].name), scene);
}

// Returns whether the scene changed while it was being opened, and opens it once more then.
bool ViewService::is_outdated(std::size_t scene) {
  const bool outdated = std::exchange(opening_[scene], Opening::no) == Opening::outdated;
  if (outdated) open(scene);
  return outdated;
}

void ViewService::opened(std::size_t scene, LoadedScene loaded) {
  const std::lock_guard lock(mutex_);
  if (is_outdated(scene)) return;
  auto renderer = std::make_shared<SceneRenderer>(std::move(loaded), settings_of(scene));
  FileWatcher watcher(renderer->files());
  const bool again = open_scenes_.contains(scene);
  open_scenes_[scene] = {std::move(renderer), std::move(watcher)};
  send_to_all(busy_message(""), scene);
  for (ClientState& state : clients_) {
    if (state.scene != scene) continue;
    send_scene(state, scene, again);
    state.pacer.restart();
  }
  // Scenes that no page shows are closed; they are opened again when a page asks for them.
  std::erase_if(open_scenes_, [&](const auto& other) {
    return other.first != scene &&
           std::ranges::none_of(clients_, [&](const ClientState& s) { return s.scene == other.first; });
  });
  changed_.notify_all();
}

void ViewService::not_opened(std::size_t scene, const std::string& why) {
  const std::lock_guard lock(mutex_);
  if (is_outdated(scene)) return;
  send_to_all(busy_message(""), scene);
  send_to_all(problem_message("scene", why), scene);
}

void ViewService::check_files() {
  const auto now = std::chrono::steady_clock::now();
  if (now - files_checked_ < kCheckEvery) return;
  files_checked_ = now;
  for (auto& [scene, open_scene] : open_scenes_)
    if (open_scene.watcher.changed()) open_anew(scene);
}

// ---- Pictures

void ViewService::run() {
  std::unique_lock lock(mutex_);
  while (!ends_) {
    check_files();
    const std::optional<Task> task = next_task();
    if (!task) {
      changed_.wait_for(lock, kCheckEvery);
      continue;
    }
    rendered_for_ = task->client.get();
    cancel_ = task->options.cancel;
    moving_ = task->work.look.moving;
    lock.unlock();
    render(*task);
    lock.lock();
    cancel_.reset();
  }
}

// Takes the first client that has work, and moves it to the end of the list (round robin).
std::optional<ViewService::Task> ViewService::next_task() {
  for (auto state = clients_.begin(); state != clients_.end(); ++state) {
    const auto found = open_scenes_.find(state->scene);
    if (found == open_scenes_.end()) continue;
    const std::optional<FramePacer::Work> work = state->pacer.next();
    if (!work || work->look.request.scene != state->scene) continue;
    Task task = task_for(*state, *work, found->second.renderer);
    clients_.splice(clients_.end(), clients_, state);
    return task;
  }
  return std::nullopt;
}

ViewService::Task ViewService::task_for(ClientState& state, const FramePacer::Work& work,
                                        const std::shared_ptr<SceneRenderer>& renderer) {
  Task task{state.client, renderer, work, render_of(work.look.request, settings_)};
  RenderOptions& o = task.options;
  const PreparedScene& shown = renderer->scene(look_of(work.look.request, settings_));
  if (o.samples == 0) o.samples = shown.settings().settings.samples.value_or(1);
  if (work.look.moving) {
    const int by = state.resolution.divide_by(static_cast<double>(o.width) * o.height);
    o = options_of({.samples = 1}, o);
    o.width = std::max(1, o.width / by);
    o.height = std::max(1, o.height / by);
  } else {
    const std::vector<Step> steps = steps_to(o);
    const Step& step = steps[std::min(work.step, steps.size() - 1)];
    o = options_of(step, o);
    task.last = step.last;
    task.kind = step.last ? "full" : "rough";
  }
  o.cancel.emplace();
  return task;
}

void ViewService::render(const Task& task) {
  try {
    const Timer timer;
    auto picture =
        std::make_shared<const Picture>(task.renderer->render(task.work.look.request, task.options));
    deliver(task, *picture, timer.seconds());
    if (task.last) pack(task, std::move(picture));
  } catch (const Error& error) {
    if (error.code() != ErrorCode::cancelled) fail(task, error.what());
  } catch (...) {
    fail(task, error_text(std::current_exception()));
  }
}

void ViewService::fail(const Task& task, const std::string& why) {
  const std::lock_guard lock(mutex_);
  ClientState* const state = find_client(*task.client);
  if (state == nullptr) return;
  state->pacer.finish(task.work, true);
  state->client->send(problem_message("look", why));
}

void ViewService::send(ClientState& state, const Task& task, FrameFacts facts, const std::string& bytes) {
  facts.frame = state.pacer.start_frame();
  facts.look = task.work.look.number;
  facts.width = task.options.width;
  facts.height = task.options.height;
  state.client->send(make_frame(frame_message(facts), bytes));
}

void ViewService::deliver(const Task& task, const Picture& picture, double seconds) {
  const Timer timer;
  const std::string bytes = as_jpeg(picture, task.options, !task.work.look.moving);
  const double encoded = timer.seconds();
  const std::lock_guard lock(mutex_);
  ClientState* const state = find_client(*task.client);
  if (state == nullptr) return;
  const bool moving = task.work.look.moving;
  const Statistics& statistics = task.renderer->statistics();
  // At rest a frame of one sample tells as much, but for what was compiled for it.
  if (moving || (task.options.samples == 1 && task.options.adaptive_target == 0))
    state->resolution.record(static_cast<double>(picture.width) * picture.height,
                             (moving ? seconds : statistics.seconds.render) + encoded);
  if (!moving && !state->pacer.is_current(task.work)) return;
  send(*state, task,
       {.kind = task.kind, .encode_seconds = encoded, .wall_seconds = seconds, .statistics = &statistics},
       bytes);
  state->pacer.finish(task.work, task.last);
}

// Has the worker send the picture as a PNG. The page has it already, but for what JPEG lost; so the next
// request doesn't wait for this.
void ViewService::pack(const Task& task, std::shared_ptr<const Picture> picture) {
  worker_.add([this, task, picture] {
    {
      const std::lock_guard lock(mutex_);
      ClientState* const state = find_client(*task.client);
      if (state == nullptr || !state->pacer.is_current(task.work)) return;
    }
    try {
      const Timer timer;
      const std::string bytes = as_png(*picture, task.options);
      const double encoded = timer.seconds();
      const ViewRequest& request = task.work.look.request;
      const std::string& file = sources_[request.scene].file;
      const std::lock_guard lock(mutex_);
      ClientState* const state = find_client(*task.client);
      if (state == nullptr || !state->pacer.is_current(task.work)) return;
      send(*state, task,
           {.kind = "final",
            .type = "image/png",
            .encode_seconds = encoded,
            .command = file.empty() ? std::string() : command_for(request, task.renderer->settings(), file)},
           bytes);
    } catch (...) {
      fail(task, error_text(std::current_exception()));
    }
    if (compiled_.exchange(false)) keep_programs(settings_.device);
  });
}

}  // namespace kdray::view
