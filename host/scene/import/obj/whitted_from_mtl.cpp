#include "scene/import/obj/whitted_from_mtl.h"

#include <algorithm>

namespace kdray::scene {

namespace {

// Ka is not used: most exporters write 1 1 1 or the diffuse colour there, which would drown the lights.
constexpr float kAmbient = 0.1f;

// The illumination models of MTL differ in which terms are on.
bool has_highlight(int illum) {
  return illum >= 2 && illum <= 9;
}
bool has_mirror(int illum) {
  return illum >= 3 && illum <= 9;
}
bool has_refraction(int illum) {
  return illum == 4 || illum == 6 || illum == 7 || illum == 9;
}
bool has_fresnel(int illum) {
  return illum == 5 || illum == 7;
}

// Schlick's reflectance averaged over a hemisphere of directions, for surfaces that can't vary it with the
// angle.
float mean_fresnel(float index) {
  const float r = (index - 1) / (index + 1);
  const float normal = r * r;
  return normal + (1 - normal) / 21;
}

float opacity(const MtlMaterial& mtl) {
  if (mtl.dissolve) return *mtl.dissolve;
  return mtl.tr ? 1 - *mtl.tr : 1;
}

// What goes through: 1 - d, coloured by Tf. A refracting material that only has Tf is as transparent as that.
vec3 transmit_of(const MtlMaterial& mtl, int illum) {
  const float through = 1 - opacity(mtl);
  if (!has_refraction(illum)) return vec3(through);
  if (through > 0) return through * mtl.tf.value_or(vec3(1));
  return mtl.tf.value_or(vec3(0));
}

float largest(const vec3& v) {
  return std::max({v.x, v.y, v.z});
}

// A surface can't send on more light than it gets.
void share_energy(int illum, Material& m) {
  const float sum = largest(m.reflect + m.transmit);
  if (sum <= 1) return;
  if (has_fresnel(illum) && largest(m.transmit) > 0) {
    m.reflect = glm::min(m.reflect, vec3(1)) * mean_fresnel(m.index);
    m.transmit *= 1 - largest(m.reflect);
  } else {
    m.reflect /= sum;
    m.transmit /= sum;
  }
}

}  // namespace

Material whitted_from_mtl(const MtlMaterial& mtl, bool has_picture) {
  const int illum = mtl.illum.value_or(2);
  vec3 kd = mtl.kd;
  // A picture is multiplied by Kd, but black is how exporters say that it alone counts. Without the picture,
  // black would be a black object.
  if (mtl.map_kd && kd == vec3(0)) kd = vec3(has_picture ? 1.0f : 0.6f);
  Material m;
  m.emission = mtl.ke;
  m.transmit = transmit_of(mtl, illum);
  m.diffuse = kd * opacity(mtl);
  m.ambient = kAmbient * m.diffuse;
  // (R.V)^0 is 1 all over the surface: Ns 0 is how exporters say that there is no highlight.
  if (has_highlight(illum) && mtl.ns > 0) {
    m.specular = mtl.ks;
    m.shine = mtl.ns;
  }
  if (has_mirror(illum)) m.reflect = mtl.ks;
  // A dissolve is a veil, not a body: it doesn't bend light.
  if (has_refraction(illum) && mtl.ni > 0) m.index = mtl.ni;
  share_energy(illum, m);
  return m;
}

}  // namespace kdray::scene
