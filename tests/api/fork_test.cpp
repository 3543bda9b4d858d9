// A process that is forked off one that has asked OpenCL for devices: told so at once, and able to end.
// (python/tests/test_processes.py has children of parents that had not.) A child that hangs is ended by a
// signal.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <optional>

#include "kdray/kdray.h"
#include "support/device.h"
#include "support/errors.h"

namespace kdray {
namespace {

using test::fails;

constexpr unsigned kLimitSeconds = 300;

// 0 where work() is true in a child, which then ends as a program does.
template <class Work>
int status_of_child(const Work& work) {
  const pid_t child = ::fork();
  if (child == 0) {
    ::alarm(kLimitSeconds);
    const bool good = work();
#ifdef __SANITIZE_ADDRESS__
    ::_exit(good ? 0 : 1);  // OpenCL's objects are the parent's: what holds them is left, and is no leak
#endif
    std::exit(good ? 0 : 1);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  return status;
}

class Fork : public test::EachDevice {
 protected:
  Scene ball(float radius) const {
    Scene scene;
    scene.add_spheres({std::vector<float>{0, 0, 0}, std::vector<float>{radius}});
    CommitOptions options;
    options.device.device = GetParam();
    scene.commit(options);
    return scene;
  }
};
KDRAY_FOR_EACH_DEVICE(Fork);

float distance_to(const Scene& scene) {
  float t = 0;
  const std::vector<float> origin{0, 0, 5}, down{0, 0, -1};
  scene.closest({origin, down}, {.t = {&t, 1}});
  return t;
}

TEST_P(Fork, AChildIsToldAtOnce) {
  const Scene scene = ball(1);
  EXPECT_EQ(distance_to(scene), 4);
  DeviceOptions device;
  device.device = GetParam();
  Renderer renderer(scene.prepared(), device);
  EXPECT_EQ(renderer.render({.width = 8, .height = 8}).width, 8);
  const auto is_told = [](const auto& ask) -> bool {
    return static_cast<bool>(fails(ask, "this process was forked off", ErrorCode::no_device));
  };
  const auto ask_all = [&] {
    return is_told([&] { distance_to(scene); }) && is_told([&] { ball(2); }) && is_told([] { devices(); }) &&
           is_told([&] { renderer.render({.width = 8, .height = 8}); }) &&
           is_told([&] { require_device(device); }) && scene.extent()->greatest[0] == 1;
  };
  EXPECT_EQ(status_of_child(ask_all), 0);
  EXPECT_EQ(status_of_child([&] { return status_of_child(ask_all) == 0; }), 0) << "a child's child";
  EXPECT_EQ(distance_to(scene), 4);
}

TEST_P(Fork, AChildCanFreeWhatItHasOfItsParent) {
  std::optional<Scene> scene(ball(1));
  DeviceOptions device;
  device.device = GetParam();
  std::optional<Renderer> renderer(std::in_place, scene->prepared(), device);
  renderer->render({.width = 8, .height = 8});
  EXPECT_EQ(distance_to(*scene), 4);
  const int status = status_of_child([&] {
    scene.reset();
    renderer.reset();
    return true;
  });
  EXPECT_EQ(status, 0);
  EXPECT_EQ(distance_to(*scene), 4);
}

TEST(Devices, ANameThatIsNotThereIsTold) {
  DeviceOptions device;
  device.device = "no such device";
  EXPECT_TRUE(fails([&] { require_device(device); }, "", ErrorCode::no_device));
  for (const std::string& there : test::usable_devices()) {
    device.device = there;
    EXPECT_NO_THROW(require_device(device));
  }
}

}  // namespace
}  // namespace kdray
