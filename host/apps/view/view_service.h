// What    Renders what pages ask for: the newest request of each, page after page, and finer pictures where
//         nothing moves; opens the scenes, opens them anew when their files change, and answers picks.
// Shape   One thread renders, another one reads scenes, encodes PNGs and picks. A request that comes while a
//         picture at rest is being rendered for that page cancels it; a frame of a camera that moves is
//         always finished, or a page whose camera moves on would never see one.
// Errors  The page gets a message that says what can't be done.
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
#include "apps/view/frame_pacer.h"
#include "apps/view/scene_renderer.h"
#include "apps/view/server.h"
#include "apps/view/worker.h"

namespace kdray::view {

class ViewService : public ClientHandler {
 public:
  // `first`: sources[0], opened already.
  ViewService(std::vector<SceneSource> sources, Settings settings, LoadedScene first);
  ~ViewService() override;
  ViewService(const ViewService&) = delete;
  ViewService& operator=(const ViewService&) = delete;

  // Opens a scene once more, if it is open; for scenes that don't come from files, whose changes would be
  // seen.
  void open_again(std::size_t scene);

  void connected(const std::shared_ptr<Client>& client) override;
  void received(const Client& client, const Message& message) override;
  void disconnected(const Client& client) override;

 private:
  // A page, with its frames in flight.
  struct ClientState {
    std::shared_ptr<Client> client;
    std::size_t scene = 0;  // the last that the page was sent a message about
    FramePacer pacer;
    ResolutionController resolution;
  };
  struct OpenScene {
    std::shared_ptr<SceneRenderer> renderer;
    FileWatcher watcher;
  };
  enum class Opening : char { no, now, outdated };  // outdated: now, and the scene has changed meanwhile
  struct Task {
    std::shared_ptr<Client> client;
    std::shared_ptr<SceneRenderer> renderer;
    FramePacer::Work work;
    RenderOptions options;
    const char* kind = "moving";
    bool last = false;
  };

  void handle(ClientState& state, const Look& look);
  void handle(ClientState& state, const Shown& shown);
  void handle(ClientState& state, const Pick& pick);
  void handle(ClientState& state, const Cells& cells);
  void handle(ClientState& state, const Smooth& smooth);
  ClientState* find_client(const Client& client);
  void send_scene(ClientState& state, std::size_t scene, bool again);
  void send_to_all(const std::string& text, std::optional<std::size_t> scene = {});

  // Returns the command line's settings, and how this scene is read.
  Settings settings_of(std::size_t scene) const;
  // Has the worker open the scene, which then calls opened() or not_opened().
  void open(std::size_t scene);
  void open_anew(std::size_t scene);
  bool is_outdated(std::size_t scene);
  void opened(std::size_t scene, LoadedScene loaded);
  void not_opened(std::size_t scene, const std::string& why);
  void check_files();

  void run();
  std::optional<Task> next_task();
  Task task_for(ClientState& state, const FramePacer::Work& work,
                const std::shared_ptr<SceneRenderer>& renderer);
  void render(const Task& task);
  void deliver(const Task& task, const Picture& picture, double seconds);
  void pack(const Task& task, std::shared_ptr<const Picture> picture);
  void fail(const Task& task, const std::string& why);
  void send(ClientState& state, const Task& task, FrameFacts facts, const std::string& bytes);

  const std::vector<SceneSource> sources_;
  Settings settings_;
  std::atomic<int> compilers_{0};
  std::atomic<bool> compiled_{false};  // programs that are not kept yet

  std::mutex mutex_;  // of all below
  std::condition_variable changed_;
  std::list<ClientState> clients_;  // in the order of the next turns (round robin)
  std::map<std::size_t, OpenScene> open_scenes_;
  std::vector<Opening> opening_;          // by scene
  std::map<std::size_t, double> smooth_;  // degrees, by scene, as a page has chosen; 0: none
  std::chrono::steady_clock::time_point files_checked_;
  std::optional<Cancel> cancel_;          // of what is being rendered,
  const Client* rendered_for_ = nullptr;  // for which page,
  bool moving_ = false;                   // and whether that is a frame that moves
  bool ends_ = false;

  std::thread thread_;
  Worker worker_;
};

}  // namespace kdray::view
