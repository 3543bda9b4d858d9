#include "accel/prepare/view.h"

#include "accel/flatten/features.h"
#include "accel/flatten/flatten.h"
#include "layout/features.h"

namespace kdray::prepare {

namespace {

void light_anew(Prepared& scene) {
  scene.flat.lights = flatten::pack_lights(scene.settings, scene.geometry.space);
  scene.features = flatten::features_in_light(scene.features, scene.settings);
}

void take_out_sky(Prepared& scene) {
  scene.settings.sky = {};
  scene.flat.sky = {}, scene.flat.sky_colors = {};
}

// Keeps what maps cut out, since that covers nothing, and removes all else of them.
void keep_holes(Prepared& white) {
  for (scene::MaterialMaps& c : white.settings.texturing.material_maps)
    c = {.alpha = c.alpha,
         .cutoff = c.cutoff,
         .base = c.base,
         .colored = c.colored,
         .mode = c.mode == scene::Alpha::mask ? c.mode : scene::Alpha::opaque};
}

}  // namespace

Prepared seen(const Prepared& prepared, const scene::View& view, const std::optional<vec3>& background,
              double aspect) {
  Prepared changed = prepared;
  scene::set_view(changed.settings, view, aspect);
  if (background) changed.settings.background = *background, take_out_sky(changed);
  light_anew(changed);
  return changed;
}

Prepared coverage_of(const Prepared& prepared) {
  constexpr flatten::Features kOfMaterials =
      KDRAY_FEATURE_REFLECT | KDRAY_FEATURE_TRANSMIT | KDRAY_FEATURE_SPECULAR | KDRAY_FEATURE_DIFFUSE;
  Prepared white = prepared;
  for (scene::Material& m : white.settings.materials) m = {.emission = vec3(1), .maps = m.maps};
  white.settings.background = vec3(0);
  take_out_sky(white);
  white.settings.lights.clear();
  keep_holes(white);
  white.flat.materials = flatten::pack_materials(white.settings);
  white.flat.material_maps = flatten::pack_material_maps(white.settings);
  white.features &= ~kOfMaterials;
  light_anew(white);
  return white;
}

}  // namespace kdray::prepare
