#include "accel/prepare/view.h"

#include "accel/flatten/features.h"
#include "accel/flatten/flatten.h"
#include "accel/flatten/textures.h"
#include "layout/features.h"

namespace kdray::prepare {

namespace {

void light_anew(Prepared& scene) {
  scene.flat.lights = flatten::pack_lights(scene.settings, scene.geometry.space);
  scene.features = flatten::features_in_light(scene.features, scene.settings);
}

void take_out_background(Prepared& scene) {
  scene.settings.background = vec3(0);
  scene.settings.sky = {};
  scene.flat.sky = {}, scene.flat.sky_colors = {};
}

// Keeps what maps cut out, since that covers nothing, and removes all else of them.
void keep_holes(Prepared& plain) {
  for (scene::MaterialMaps& maps : plain.settings.texturing.material_maps)
    maps = {.alpha = maps.alpha,
            .cutoff = maps.cutoff,
            .base = maps.base,
            .colored = maps.colored,
            .mode = maps.mode == scene::Alpha::mask ? maps.mode : scene::Alpha::opaque};
}

}  // namespace

// The sky is the scene's own, as it lies packed there, or none, or one that the view has brought.
Prepared seen(const Prepared& prepared, const scene::View& view, double aspect, const scene::Scene* first) {
  Prepared changed = prepared;
  scene::set_view(changed.settings, view, aspect, first);
  if (prepared.settings.sky.kind == scene::SkyKind::none ||
      changed.settings.sky.kind == scene::SkyKind::none) {
    changed.flat.sky = {}, changed.flat.sky_colors = {};
    flatten::pack_sky(changed.settings.sky, changed.flat);
  }
  light_anew(changed);
  return changed;
}

Prepared shining(const Prepared& prepared, const vec3& emission, bool before_background) {
  constexpr flatten::Features kOfMaterials =
      KDRAY_FEATURE_REFLECT | KDRAY_FEATURE_TRANSMIT | KDRAY_FEATURE_SPECULAR | KDRAY_FEATURE_DIFFUSE;
  Prepared plain = prepared;
  for (scene::Material& m : plain.settings.materials) m = {.emission = emission, .maps = m.maps};
  if (!before_background) take_out_background(plain);
  plain.settings.framing.floor = {};
  plain.settings.lights.clear();
  keep_holes(plain);
  plain.flat.materials = flatten::pack_materials(plain.settings);
  plain.flat.material_maps = flatten::pack_material_maps(plain.settings);
  plain.features &= ~kOfMaterials;
  light_anew(plain);
  return plain;
}

}  // namespace kdray::prepare
