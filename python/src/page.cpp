// The page of a scene (host/apps/view), served by this process until it is closed.
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include <unistd.h>

#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "apps/view/server.h"
#include "apps/view/view_service.h"
#include "interrupt.h"
#include "parts.h"

namespace kdray::python {

namespace {

namespace nb = nanobind;
using namespace nb::literals;
// These are: from, at, up, fov, ortho_width, hither, aperture, focus.
using CameraNumbers = std::array<double, 14>;

// As it was committed last, with the ids and names of its geometries.
view::LoadedScene opened(const Scene& scene) {
  view::LoadedScene opened{scene.prepared(), {}};
  for (const GeometryId id : scene.geometries()) {
    const GeometryInfo info = scene.info(id);
    if (info.enabled) opened.geometries.push_back({info.name, id, info.primitives});
  }
  return opened;
}

View view_of(const std::optional<CameraNumbers>& camera) {
  View view;
  if (!camera) return view;
  const CameraNumbers& n = *camera;
  view.from = {n[0], n[1], n[2]};
  view.at = {n[3], n[4], n[5]};
  view.up = {n[6], n[7], n[8]};
  if (n[10] > 0)
    view.ortho_width = n[10];
  else
    view.fov = n[9];
  if (n[12] > 0) view.aperture = n[12];
  if (n[13] > 0) view.focus = n[13];
  return view;
}

// Its threads are kdray's own and never call Python.
class Page {
 public:
  Page(const Scene& scene, const std::string& name, const std::optional<CameraNumbers>& camera,
       const std::string& device, int compute_units, int port, bool framed, const std::string& look)
      : scene_(opened(scene)),
        served_(std::make_unique<Served>(view::ServerOptions{.port = port, .framed = framed})),
        address_(served_->server.address()) {
    view::Settings settings;
    settings.view = view_of(camera);
    settings.look = look_of(look);
    settings.device.device = device;
    settings.device.compute_units = compute_units;
    settings.device.programs = default_program_folder();
    settings.device.remember_programs = true;
    served_->service.emplace(
        std::vector<view::SceneSource>{{name, "", [this](const LoadOptions&) { return scene_now(); }}},
        settings, scene_);
    served_->thread = std::thread([s = served_.get()] { s->server.run(*s->service); });
  }
  ~Page() { close(); }
  Page(const Page&) = delete;
  Page& operator=(const Page&) = delete;

  const std::string& address() const { return address_; }

  void update(const Scene& scene) {
    view::LoadedScene now = opened(scene);
    {
      const std::lock_guard lock(mutex_);
      scene_ = std::move(now);
    }
    const std::lock_guard lock(closing_);
    if (served_) served_->service->open_again(0);
  }

  void close() {
    if (::getpid() != process_) return static_cast<void>(served_.release());  // the threads are the parent's
    const std::lock_guard lock(closing_);
    if (!served_) return;
    served_->server.stop();
    served_->thread.join();
    served_.reset();
  }

 private:
  struct Served {
    explicit Served(const view::ServerOptions& options) : server(options) {}
    view::Server server;
    std::optional<view::ViewService> service;  // ends before the server: it holds clients
    std::thread thread;
  };

  view::LoadedScene scene_now() {
    const std::lock_guard lock(mutex_);
    return scene_;
  }

  std::mutex mutex_, closing_;
  view::LoadedScene scene_;         // by `mutex_`
  std::unique_ptr<Served> served_;  // null: closed
  std::string address_;
  pid_t process_ = ::getpid();
};

}  // namespace

void add_page(nb::module_& module) {
  nb::class_<Page>(module, "Page")
      .def(nb::init<const Scene&, const std::string&, const std::optional<CameraNumbers>&, const std::string&,
                    int, int, bool, const std::string&>(),
           Released(), "scene"_a, "name"_a, "camera"_a.none(), "device"_a, "compute_units"_a, "port"_a,
           "framed"_a, "look"_a)
      .def("address", &Page::address)
      .def("update", &Page::update, Released(), "scene"_a)
      .def("close", &Page::close, Released());
}

}  // namespace kdray::python
