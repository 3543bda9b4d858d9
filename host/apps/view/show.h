// What    Renders what pages want to see: the newest sight of each, page after page, and finer pictures where
//         nothing moves; opens the scenes, opens them anew when their files change, and answers picks.
// Shape   A thread renders, another one reads scenes, packs PNGs and picks. A look that comes while a picture
//         at rest is being rendered for that page ends it; a frame that moves is always finished, or a page
//         whose camera moves on would never see one.
// Errors  What can't be done is told to the page.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "apps/view/facts.h"
#include "apps/view/guest.h"
#include "apps/view/stage.h"
#include "apps/view/visitor.h"
#include "apps/view/watch.h"
#include "apps/view/worker.h"

namespace kdray::view {

class Show : public Reception {
 public:
  // `first`: sources[0], opened already.
  Show(std::vector<Source> sources, Settings settings, Opened first);
  ~Show() override;
  Show(const Show&) = delete;
  Show& operator=(const Show&) = delete;

  // What pages see of a scene is opened once more; for one that has no files that would tell of a change.
  void open_again(std::size_t scene);

  void enter(const std::shared_ptr<Visitor>& visitor) override;
  void hear(const Visitor& visitor, const Message& message) override;
  void leave(const Visitor& visitor) override;

 private:
  // A page, with what it is owed.
  struct Seat {
    std::shared_ptr<Visitor> visitor;
    std::size_t scene = 0;  // that it was told of
    Guest guest;
    Ladder ladder;
  };
  struct Act {  // a scene that is open
    std::shared_ptr<Stage> stage;
    Watch watch;
  };
  enum class Opening : char { no, now, outdated };  // outdated: now, and it has changed meanwhile
  struct Task {
    std::shared_ptr<Visitor> visitor;
    std::shared_ptr<Stage> stage;
    Guest::Work work;
    RenderOptions options;
    const char* kind = "moving";
    bool last = false;
  };

  void take(Seat& seat, const Look& look);
  void take(Seat& seat, const Shown& shown);
  void take(Seat& seat, const Pick& pick);
  void take(Seat& seat, const Cells& cells);
  Seat* seat_of(const Visitor& visitor);
  void tell(Seat& seat, std::size_t scene, bool again);
  void tell_all(const std::string& text, std::optional<std::size_t> scene = {});

  // Of scenes; both end in the worker.
  void open(std::size_t scene);
  void open_anew(std::size_t scene);
  bool is_outdated(std::size_t scene);
  void opened(std::size_t scene, Opened scene_opened);
  void not_opened(std::size_t scene, const std::string& why);
  void look_at_files();

  void run();
  std::optional<Task> next_task();
  Task task_for(Seat& seat, const Guest::Work& work, const std::shared_ptr<Stage>& stage);
  void render(const Task& task);
  void deliver(const Task& task, const Picture& picture, double seconds);
  void pack(const Task& task, std::shared_ptr<const Picture> picture);
  void fail(const Task& task, const std::string& why);
  void send(Seat& seat, const Task& task, FrameFacts facts, const std::string& bytes);

  const std::vector<Source> sources_;
  Settings settings_;
  std::atomic<int> compilers_{0};
  std::atomic<bool> compiled_{false};  // something that is not kept yet

  std::mutex mutex_;  // of all below
  std::condition_variable changed_;
  std::list<Seat> seats_;  // the one whose turn it is first
  std::map<std::size_t, Act> acts_;
  std::vector<Opening> opening_;  // by scene
  std::chrono::steady_clock::time_point looked_at_files_;
  std::optional<Cancel> cancel_;           // of what is being rendered,
  const Visitor* rendered_for_ = nullptr;  // for whom,
  bool moving_ = false;                    // and whether that is a frame that moves
  bool ends_ = false;

  std::thread thread_;
  Worker worker_;
};

}  // namespace kdray::view
