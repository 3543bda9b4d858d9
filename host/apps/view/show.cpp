#include "apps/view/show.h"

#include <algorithm>
#include <new>
#include <utility>

#include "apps/view/cells.h"
#include "apps/view/pixels.h"
#include "base/timer.h"

namespace kdray::view {

namespace {

using namespace std::chrono_literals;
constexpr auto kLookEvery = 300ms;        // at files
constexpr std::size_t kMostErrands = 64;  // that wait for the worker

std::string words_of(std::exception_ptr error) {
  try {
    std::rethrow_exception(std::move(error));
  } catch (const std::bad_alloc&) {
    return "out of memory";
  } catch (const std::exception& e) {
    return e.what();
  }
}

}  // namespace

Show::Show(std::vector<Source> sources, Settings settings, Opened first)
    : sources_(std::move(sources)),
      settings_(std::move(settings)),
      opening_(sources_.size()),
      worker_(kMostErrands) {
  // Compilers may nest; the page hears of the first and of the last.
  settings_.device.building = [this](bool begins) {
    const int before = compilers_.fetch_add(begins ? 1 : -1);
    if (!begins) compiled_ = true;
    if (before != (begins ? 0 : 1)) return;
    const std::lock_guard lock(mutex_);
    tell_all(tell_busy(begins ? "compiling for what this scene needs" : ""));
  };
  auto stage = std::make_shared<Stage>(std::move(first), settings_);
  Watch watch(stage->files());
  acts_.emplace(0, Act{std::move(stage), std::move(watch)});
  thread_ = std::thread([this] { run(); });
}

Show::~Show() {
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
    if (cancel_) cancel_->cancel();
  }
  changed_.notify_all();
  thread_.join();
}

// ---- What pages say

Show::Seat* Show::seat_of(const Visitor& visitor) {
  const auto found = std::ranges::find_if(seats_, [&](const Seat& s) { return s.visitor.get() == &visitor; });
  return found == seats_.end() ? nullptr : &*found;
}

void Show::enter(const std::shared_ptr<Visitor>& visitor) {
  const std::lock_guard lock(mutex_);
  Seat& seat = seats_.emplace_back();
  seat.visitor = visitor;
  acts_.contains(0) ? tell(seat, 0, false) : open(0);
}

void Show::leave(const Visitor& visitor) {
  const std::lock_guard lock(mutex_);
  if (cancel_ && rendered_for_ == &visitor) cancel_->cancel();
  seats_.remove_if([&](const Seat& seat) { return seat.visitor.get() == &visitor; });
}

void Show::hear(const Visitor& visitor, const Message& message) {
  const std::lock_guard lock(mutex_);
  Seat* const seat = seat_of(visitor);
  if (seat != nullptr) std::visit([&](const auto& m) { take(*seat, m); }, message);
}

// A page that looks at a scene which it wasn't told of is told, and takes the camera from there.
void Show::take(Seat& seat, const Look& look) {
  const std::size_t scene = look.sight.scene;
  if (scene >= sources_.size()) throw Error(ErrorCode::input, "the page's message: there is no such scene");
  if (scene != seat.scene || !acts_.contains(scene)) {
    seat.scene = scene;
    acts_.contains(scene) ? tell(seat, scene, false) : open(scene);
    return;
  }
  seat.guest.ask(look);
  if (cancel_ && rendered_for_ == seat.visitor.get() && !moving_) cancel_->cancel();
  changed_.notify_all();
}

void Show::take(Seat& seat, const Shown& shown) {
  if (!seat.guest.shown(shown.frame))
    throw Error(ErrorCode::input, "the page's message: there was no such frame");
  changed_.notify_all();
}

void Show::take(Seat& seat, const Pick& pick) {
  const auto act = acts_.find(pick.sight.scene);
  if (act == acts_.end()) return;
  worker_.add([visitor = seat.visitor, stage = act->second.stage, pick] {
    try {
      visitor->send(tell_picked(pick.number, stage->pick(pick.sight, pick.x, pick.y), stage->scene()));
    } catch (...) {
      visitor->send(tell_problem("pick", words_of(std::current_exception())));
    }
  });
}

void Show::take(Seat& seat, const Cells& cells) {
  const auto act = acts_.find(cells.scene);
  if (act == acts_.end()) return;
  worker_.add([visitor = seat.visitor, stage = act->second.stage, cells] {
    const auto boxes =
        cells.depth > 0 ? cells_of(stage->scene().prepared(), cells.depth) : std::vector<DBox>();
    visitor->send(tell_cells(cells.scene, cells.depth, boxes));
  });
}

void Show::tell(Seat& seat, std::size_t scene, bool again) {
  seat.scene = scene;
  seat.visitor->send(tell_scene(sources_, scene, *acts_.at(scene).stage, settings_, again));
}

void Show::tell_all(const std::string& text, std::optional<std::size_t> scene) {
  for (Seat& seat : seats_)
    if (!scene || seat.scene == *scene) seat.visitor->send(text);
}

// ---- Scenes

void Show::open_again(std::size_t scene) {
  const std::lock_guard lock(mutex_);
  if (acts_.contains(scene)) open_anew(scene);
}

void Show::open_anew(std::size_t scene) {
  if (opening_[scene] == Opening::no)
    open(scene);
  else
    opening_[scene] = Opening::outdated;
}

void Show::open(std::size_t scene) {
  if (opening_[scene] != Opening::no) return;
  const bool begins = worker_.add([this, scene] {
    try {
      opened(scene, sources_[scene].open());
    } catch (...) {
      not_opened(scene, words_of(std::current_exception()));
    }
  });
  if (!begins) return tell_all(tell_problem("scene", "too much is waiting to be done; ask again"), scene);
  opening_[scene] = Opening::now;
  tell_all(tell_busy("opening " + sources_[scene].name), scene);
}

// Whether what has been opened is to be opened once more.
bool Show::is_outdated(std::size_t scene) {
  const bool outdated = std::exchange(opening_[scene], Opening::no) == Opening::outdated;
  if (outdated) open(scene);
  return outdated;
}

void Show::opened(std::size_t scene, Opened scene_opened) {
  auto stage = std::make_shared<Stage>(std::move(scene_opened), settings_);
  Watch watch(stage->files());
  const std::lock_guard lock(mutex_);
  if (is_outdated(scene)) return;
  const bool again = acts_.contains(scene);
  acts_[scene] = {std::move(stage), std::move(watch)};
  tell_all(tell_busy(""), scene);
  for (Seat& seat : seats_) {
    if (seat.scene != scene) continue;
    tell(seat, scene, again);
    seat.guest.begin_anew();
  }
  // Nobody looks at the others; they are opened again when somebody does.
  std::erase_if(acts_, [&](const auto& act) {
    return act.first != scene &&
           std::ranges::none_of(seats_, [&](const Seat& s) { return s.scene == act.first; });
  });
  changed_.notify_all();
}

void Show::not_opened(std::size_t scene, const std::string& why) {
  const std::lock_guard lock(mutex_);
  if (is_outdated(scene)) return;
  tell_all(tell_busy(""), scene);
  tell_all(tell_problem("scene", why), scene);
}

void Show::look_at_files() {
  const auto now = std::chrono::steady_clock::now();
  if (now - looked_at_files_ < kLookEvery) return;
  looked_at_files_ = now;
  for (auto& [scene, act] : acts_)
    if (act.watch.changed()) open_anew(scene);
}

// ---- Pictures

void Show::run() {
  std::unique_lock lock(mutex_);
  while (!ends_) {
    look_at_files();
    const std::optional<Task> task = next_task();
    if (!task) {
      changed_.wait_for(lock, kLookEvery);
      continue;
    }
    rendered_for_ = task->visitor.get();
    cancel_ = task->options.cancel;
    moving_ = task->work.look.moving;
    lock.unlock();
    render(*task);
    lock.lock();
    cancel_.reset();
  }
}

// The first seat that wants something goes to the end of the row.
std::optional<Show::Task> Show::next_task() {
  for (auto seat = seats_.begin(); seat != seats_.end(); ++seat) {
    const auto act = acts_.find(seat->scene);
    if (act == acts_.end()) continue;
    const std::optional<Guest::Work> work = seat->guest.next();
    if (!work || work->look.sight.scene != seat->scene) continue;
    Task task = task_for(*seat, *work, act->second.stage);
    seats_.splice(seats_.end(), seats_, seat);
    return task;
  }
  return std::nullopt;
}

Show::Task Show::task_for(Seat& seat, const Guest::Work& work, const std::shared_ptr<Stage>& stage) {
  Task task{seat.visitor, stage, work, render_of(work.look.sight, settings_)};
  RenderOptions& o = task.options;
  if (o.samples == 0) o.samples = stage->scene().settings().settings.samples.value_or(1);
  if (work.look.moving) {
    const int by = seat.ladder.divide_by(static_cast<double>(o.width) * o.height);
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

void Show::render(const Task& task) {
  try {
    const Timer timer;
    auto picture = std::make_shared<const Picture>(task.stage->render(task.work.look.sight, task.options));
    deliver(task, *picture, timer.seconds());
    if (task.last) pack(task, std::move(picture));
  } catch (const Error& error) {
    if (error.code() != ErrorCode::cancelled) fail(task, error.what());
  } catch (...) {
    fail(task, words_of(std::current_exception()));
  }
}

void Show::fail(const Task& task, const std::string& why) {
  const std::lock_guard lock(mutex_);
  Seat* const seat = seat_of(*task.visitor);
  if (seat == nullptr) return;
  seat->guest.done(task.work, true);
  seat->visitor->send(tell_problem("look", why));
}

void Show::send(Seat& seat, const Task& task, FrameFacts facts, const std::string& bytes) {
  facts.frame = seat.guest.send();
  facts.look = task.work.look.number;
  facts.width = task.options.width;
  facts.height = task.options.height;
  seat.visitor->send(make_frame(tell_frame(facts), bytes));
}

void Show::deliver(const Task& task, const Picture& picture, double seconds) {
  const Timer timer;
  const std::string bytes = as_jpeg(picture, task.options, !task.work.look.moving);
  const double encoded = timer.seconds();
  const std::lock_guard lock(mutex_);
  Seat* const seat = seat_of(*task.visitor);
  if (seat == nullptr) return;
  const bool moving = task.work.look.moving;
  const Statistics& statistics = task.stage->statistics();
  // At rest a frame of one sample tells as much, but for what was compiled for it.
  if (moving || (task.options.samples == 1 && task.options.adaptive_target == 0))
    seat->ladder.took(static_cast<double>(picture.width) * picture.height,
                      (moving ? seconds : statistics.seconds.render) + encoded);
  if (!moving && !seat->guest.wants(task.work)) return;
  send(*seat, task,
       {.kind = task.kind, .encode_seconds = encoded, .wall_seconds = seconds, .statistics = &statistics},
       bytes);
  seat->guest.done(task.work, task.last);
}

// The page has the picture already, but for what JPEG lost of it; so the next sight doesn't wait for this.
void Show::pack(const Task& task, std::shared_ptr<const Picture> picture) {
  worker_.add([this, task, picture] {
    {
      const std::lock_guard lock(mutex_);
      Seat* const seat = seat_of(*task.visitor);
      if (seat == nullptr || !seat->guest.wants(task.work)) return;
    }
    try {
      const Timer timer;
      const std::string bytes = as_png(*picture, task.options);
      const double encoded = timer.seconds();
      const Sight& sight = task.work.look.sight;
      const std::string& file = sources_[sight.scene].file;
      const std::lock_guard lock(mutex_);
      Seat* const seat = seat_of(*task.visitor);
      if (seat == nullptr || !seat->guest.wants(task.work)) return;
      send(*seat, task,
           {.kind = "final",
            .type = "image/png",
            .encode_seconds = encoded,
            .command = file.empty() ? std::string() : command_for(sight, settings_, file)},
           bytes);
    } catch (...) {
      fail(task, words_of(std::current_exception()));
    }
    if (compiled_.exchange(false)) keep_programs(settings_.device);
  });
}

}  // namespace kdray::view
