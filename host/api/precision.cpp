#include "api/precision.h"

#include <fmt/format.h>

#include "accel/prepare/instanced.h"
#include "engine/wavefront/channels.h"

#include <algorithm>

namespace kdray::api {

Traversal traversal_in(Precision precision, Traversal wanted, const DeviceInfo& device) {
  if (precision == Precision::float32) return wanted;
  if (wanted != Traversal::automatic && wanted != Traversal::binary)
    throw Error(ErrorCode::usage,
                "double precision has the binary walk alone; leave traversal out, or take binary");
  if (!device.double_precision)
    throw Error(
        ErrorCode::no_device,
        fmt::format("{} does not compute in double; take float precision, or another device", device.name));
  return Traversal::binary;
}

Traversal traversal_of_rays(Precision precision, Traversal wanted, const engine::DeviceScene& devices) {
  Traversal traversal = wanted;
  for (const engine::Device& device : devices)
    traversal = traversal_in(precision, wanted, device.context.info());
  check_form(takes_binary_form(traversal, precision), devices.scene());
  return traversal;
}

void check_form(bool is_walked, const prepare::Prepared& scene) {
  if (is_walked) prepare::refuse_instances(scene, "the binary walk, which double takes,");
  if (is_walked && scene.flat.nodes.empty())
    throw Error(
        ErrorCode::usage,
        "the scene was prepared without the tree's binary form, which the binary walk, double and channels "
        "take; set TreeOptions::binary_form");
}

void check_channels(const RenderOptions& options, const prepare::Prepared& scene) {
  wavefront::check_channels(options.channels);
  const bool of_instances = !scene.flat.instances.empty();
  const std::span<const std::string> by_binary_walk =
      of_instances ? std::span<const std::string>() : std::span<const std::string>(options.channels);
  check_form(takes_binary_form(options.traversal, options.precision, by_binary_walk), scene);
  const auto has = [&](const char* name) {
    return std::ranges::find(options.channels, name) != options.channels.end();
  };
  if (scene.doubles && scene.doubles->copies.size() > 0 && (has("primitive") || has("instance")))
    throw Error(ErrorCode::usage,
                "the channels primitive and instance can't number the copies that double geometry makes of "
                "instances; take float geometry for these");
  if (of_instances && has("cost"))
    prepare::refuse_instances(scene, "the channel cost, which counts the binary walk's steps,");
}

void check_division(const RenderOptions& options) {
  if (options.precision == Precision::float32) return;
  if (options.mode == Mode::odprt)
    throw Error(ErrorCode::usage, "odprt is float's alone; take mode pdprt for double precision");
  if (options.device_memory > 0)
    throw Error(
        ErrorCode::usage,
        "device memory is limited in odprt, which is float's alone; set no limit for double precision");
}

}  // namespace kdray::api

namespace kdray {

bool takes_binary_form(Traversal traversal, Precision precision, std::span<const std::string> channels) {
  return traversal == Traversal::binary || precision == Precision::float64 ||
         std::any_of(channels.begin(), channels.end(), [](const std::string& c) { return c != "samples"; });
}

}  // namespace kdray
