// What    What lies at a point of a picture: the primitive, its geometry and its material, where, and how
//         far.
// Errors  kdray::Error, as queries have them.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "kdray/kdray.h"

namespace kdray::api {
class Committed;
}

namespace kdray::view {

// A geometry among all of a scene's primitives, which are numbered from 0 one after the other.
struct GeometryName {
  std::string name;
  std::uint32_t id = 0, primitives = 0;
};

struct Picked {
  double distance = 0;
  Vec3 point{}, normal{};
  std::uint32_t geometry = 0, primitive = 0;  // of the geometry, from 0
  // Where it lies in an instance: its place in the scene's list. The primitive is its mesh's then, and no
  // geometry is named.
  std::optional<std::uint32_t> instance;
  std::string geometry_name, kind;
  std::string part;  // of its file, by the name that it has there; empty: none
  std::optional<std::uint32_t> material;
};

// A ray of an eye through that point of the picture, in shares from the upper left corner.
struct EyeRay {
  Vec3 origin, direction;  // of unit length
};
EyeRay eye_ray(const Camera& camera, double aspect, double x, double y);

class Picker {
 public:
  Picker(const PreparedScene& scene, std::vector<GeometryName> geometries, const DeviceOptions& device);
  ~Picker();

  std::optional<Picked> pick(const EyeRay& ray);

 private:
  void name(std::uint32_t number, Picked& picked) const;
  void name_instance(std::uint32_t number, std::uint32_t instance, Picked& picked) const;

  PreparedScene scene_;
  std::vector<GeometryName> geometries_;
  std::unique_ptr<api::Committed> asked_;
};

}  // namespace kdray::view
