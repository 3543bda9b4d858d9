/* What    Uses the C interface as a C99 program would: answers that are known, and what is wrong, told.
 * Errors  Status 1, with a line for each wrong answer. Without a device: says so, status 0. */
#include <kdray.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

static int failures = 0;

static void expect(int good, const char* what) {
  if (!good) fprintf(stderr, "wrong: %s (%s)\n", what, kdray_last_error()), ++failures;
}

static const float corners[24] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1};
static const uint32_t faces[36] = {0, 2, 1, 0, 3, 2, 4, 5, 6, 4, 6, 7, 0, 1, 5, 0, 5, 4,
                                   1, 2, 6, 1, 6, 5, 2, 3, 7, 2, 7, 6, 3, 0, 4, 3, 4, 7};

static kdray_in floats(const float* data, size_t count) {
  kdray_in in = {data, count, 0, KDRAY_FLOAT32};
  return in;
}
static kdray_in doubles(const double* data, size_t count) {
  kdray_in in = {data, count, 0, KDRAY_FLOAT64};
  return in;
}

static void check_what_is_wrong(kdray_scene* scene) {
  kdray_in none = {0}, vertices = floats(corners, 8), triangles = {faces, 12, 0, KDRAY_UINT32};
  kdray_geometry_options unsized = {0};
  kdray_rays rays = {0};
  uint32_t counts[2];
  kdray_out overlapping = {counts, 2, 0, KDRAY_UINT32};
  kdray_load_options unsized_load = {0}, wrong_load = {0};
  uint32_t beyond[3] = {0, 1, 8};
  kdray_in bad = {beyond, 1, 0, KDRAY_UINT32}, of_floats = {faces, 12, 0, KDRAY_FLOAT32},
           null = {NULL, 8, 0, KDRAY_FLOAT32};
  expect(kdray_scene_new(NULL) == KDRAY_USAGE, "nowhere to put a scene");
  expect(kdray_add_mesh(NULL, vertices, triangles, none, NULL, NULL) == KDRAY_USAGE, "no scene");
  expect(kdray_add_mesh(scene, null, triangles, none, NULL, NULL) == KDRAY_INPUT, "no data");
  expect(strstr(kdray_last_error(), "vertices") != NULL, "the array is named");
  expect(kdray_add_mesh(scene, vertices, of_floats, none, NULL, NULL) == KDRAY_INPUT,
         "indices that are floats");
  expect(strstr(kdray_last_error(), "triangles: its type is 1; it is to be uint32 or int32 or") != NULL,
         "the types that it may have are named");
  overlapping.stride = 2;
  rays.size = sizeof rays, rays.origins = floats(corners, 2), rays.directions = floats(corners + 3, 2);
  expect(kdray_count(scene, &rays, overlapping, NULL) != KDRAY_OK &&
             strstr(kdray_last_error(), "counts: ") != NULL,
         "an array is named whose rows overlap");
  expect(kdray_add_mesh(scene, vertices, bad, none, NULL, NULL) == KDRAY_INPUT, "an index beyond all");
  expect(strstr(kdray_last_error(), "triangles[0]") != NULL, "the element is named");
  expect(kdray_add_mesh(scene, vertices, triangles, none, &unsized, NULL) == KDRAY_USAGE,
         "a struct without its size");
  unsized.size = (size_t)-1;
  expect(kdray_add_mesh(scene, vertices, triangles, none, &unsized, NULL) == KDRAY_USAGE,
         "a size that is none");
  expect(kdray_remove(scene, 7) == KDRAY_USAGE, "a geometry that isn't there");
  expect(kdray_scene_load("no/such/file.obj", NULL, &scene) == KDRAY_INPUT, "a file that isn't there");
  expect(kdray_scene_load("no/such/file.obj", &unsized_load, &scene) == KDRAY_USAGE,
         "options of loading without their size");
  wrong_load.size = sizeof wrong_load;
  wrong_load.instances = 3;
  expect(kdray_scene_load("no/such/file.obj", &wrong_load, &scene) == KDRAY_USAGE, "no such choice");
  expect(kdray_count(scene, NULL, (kdray_out){0}, NULL) != KDRAY_OK, "no rays");
  kdray_scene_free(NULL);
  kdray_all_hits_free(NULL);
  kdray_cancel_free(NULL);
}

static void check_names(void) {
  kdray_scene* scene = NULL;
  kdray_in none = {0}, triangles = {faces, 12, 0, KDRAY_UINT32};
  kdray_geometry_options options = {0};
  uint32_t box = 9;
  char name[8] = "";
  options.size = sizeof options;
  options.name = "a box";
  expect(kdray_scene_new(&scene) == KDRAY_OK, "a scene");
  expect(kdray_add_mesh(scene, floats(corners, 8), triangles, none, &options, &box) == KDRAY_OK, "a mesh");
  expect(kdray_name_of(scene, box, 3, KDRAY_NO_INSTANCE, name, sizeof name) == KDRAY_OK &&
             strcmp(name, "a box") == 0,
         "its name");
  expect(kdray_name_of(scene, box, 3, KDRAY_NO_INSTANCE, name, 4) == KDRAY_OK && strcmp(name, "a b") == 0,
         "as much of its name as fits");
  expect(kdray_name_of(scene, box, 3, KDRAY_NO_INSTANCE, name, 0) == KDRAY_USAGE, "no bytes for a name");
  expect(kdray_name_of(scene, 7, 3, KDRAY_NO_INSTANCE, name, sizeof name) == KDRAY_USAGE, "no such geometry");
  kdray_scene_free(scene);
}

static void check_answers(const kdray_scene* scene, uint32_t box) {
  const double origins[6] = {0.25, 0.5, 5, 9, 9, 9}, down[3] = {0, 0, -2};
  double t[2];
  uint32_t geometry[2], counts[2];
  uint8_t hit[2], inside = 9;
  const double point[3] = {0.5, 0.25, 0.125};
  double distance = 0;
  uint64_t n_invalid = 9;
  kdray_rays rays = {0};
  kdray_hits hits = {0};
  kdray_query_options options = {0};
  kdray_all_hits* all = NULL;
  kdray_all_hits_view view = {0};
  kdray_out out = {counts, 2, 0, KDRAY_UINT32};
  rays.size = sizeof rays;
  rays.origins = doubles(origins, 2);
  rays.directions = doubles(down, 1);
  hits.size = sizeof hits;
  hits.t.data = t, hits.t.count = 2, hits.t.type = KDRAY_FLOAT64;
  hits.geometry.data = geometry, hits.geometry.count = 2, hits.geometry.type = KDRAY_UINT32;
  options.size = sizeof options;
  options.n_invalid = &n_invalid;
  expect(kdray_closest(scene, &rays, &hits, &options) == KDRAY_OK, "closest");
  expect(t[0] == 2 && isinf(t[1]) && geometry[0] == box && geometry[1] == KDRAY_NO_GEOMETRY, "what is hit");
  expect(n_invalid == 0, "no invalid rays");
  expect(kdray_count(scene, &rays, out, NULL) == KDRAY_OK && counts[0] == 2 && counts[1] == 0, "count");
  expect(kdray_any(scene, &rays, (kdray_out){hit, 2, 0, KDRAY_UINT8}, NULL) == KDRAY_OK && hit[0] == 1 &&
             hit[1] == 0,
         "any");
  view.size = sizeof view;
  expect(kdray_all(scene, &rays, 0, NULL, &all) == KDRAY_OK && kdray_all_hits_get(all, &view) == KDRAY_OK,
         "all");
  expect(view.n_rays == 2 && view.splits[1] == 2 && view.splits[2] == 2 && view.t[0] == 2 && view.t[1] == 2.5,
         "all hits");
  kdray_all_hits_free(all);
  expect(kdray_inside(scene, doubles(point, 1), (kdray_out){&inside, 1, 0, KDRAY_UINT8}, NULL) == KDRAY_OK &&
             inside == 1,
         "inside");
  expect(kdray_signed_distance(scene, doubles(point, 1), (kdray_out){&distance, 1, 0, KDRAY_FLOAT64}, NULL) ==
                 KDRAY_OK &&
             distance == -0.125,
         "signed distance");
  rays.origins = doubles(origins, 2), rays.origins.stride = KDRAY_SAME_ROW;
  expect(kdray_closest(scene, &rays, &hits, NULL) == KDRAY_OK && t[0] == 2 && t[1] == 2, "one row for all");
  rays.origins.stride = (size_t)-24;
  expect(kdray_closest(scene, &rays, &hits, NULL) == KDRAY_INPUT, "rows before the first");
  rays.origins = doubles(origins, 2);
  hits.t.stride = KDRAY_SAME_ROW;
  expect(kdray_closest(scene, &rays, &hits, NULL) == KDRAY_INPUT, "answers that overlap");
  hits.t.stride = 0;
  hits.t.count = 1;
  expect(kdray_closest(scene, &rays, &hits, NULL) == KDRAY_INPUT, "too few places");
}

/* A corner of the picture and its middle, of the box's upper side as it is seen from above. */
static void expect_colors(const kdray_scene* scene, const float (*sides)[3], const char* what) {
  static float rgb[3 * 16 * 16];
  kdray_picture_options picture = {0};
  int at, k;
  picture.size = sizeof picture;
  picture.width = picture.height = 16;
  expect(kdray_render(scene, &picture, rgb, sizeof rgb / sizeof rgb[0]) == KDRAY_OK, what);
  for (at = 0; at < 2; ++at)
    for (k = 0; k < 3; ++k) expect(fabsf(rgb[3 * at * (8 * 16 + 8) + k] - sides[at][k]) < 1e-5f, what);
}

/* The usual material is 0.8 of diffuse and 0.08 of ambient light. */
static void check_looks(void) {
  const float background[3] = {0.25f, 0.5f, 0.75f}, ambient[3] = {0, 0.5f, 1}, dark[3] = {0, 0, 0},
              negative[3] = {0, -1, 0};
  const float lit[2][3] = {{0.25f, 0.5f, 0.75f}, {0.4f, 0.84f, 0.88f}};
  const float from_below[2][3] = {{0, 0, 0}, {0, 0, 0}};
  kdray_in none = {0}, triangles = {faces, 12, 0, KDRAY_UINT32};
  kdray_scene* scene = NULL;
  kdray_light light = {0};
  kdray_camera camera = {0};
  light.size = sizeof light, camera.size = sizeof camera;
  expect(kdray_scene_new(&scene) == KDRAY_OK, "a scene");
  expect(kdray_add_mesh(scene, floats(corners, 8), triangles, none, NULL, NULL) == KDRAY_OK, "a mesh");
  light.kind = 99;
  expect(kdray_add_light(scene, &light) == KDRAY_USAGE, "a light of no kind");
  light.kind = KDRAY_SPOT_LIGHT, light.outer_degrees = 200;
  expect(kdray_add_light(scene, &light) == KDRAY_INPUT, "an angle beyond all");
  light.kind = KDRAY_DIRECTIONAL_LIGHT, light.outer_degrees = 0; /* down, which is its default */
  light.color[0] = 0.5f, light.color[1] = light.color[2] = 1;
  expect(kdray_add_light(scene, &light) == KDRAY_OK, "a light");
  expect(kdray_add_light(scene, NULL) == KDRAY_USAGE, "no light");
  camera.from[0] = camera.from[1] = camera.at[0] = camera.at[1] = 0.5, camera.from[2] = 4;
  camera.ortho_width = 2;
  expect(kdray_set_camera(scene, &camera) == KDRAY_OK, "a camera");
  camera.ortho_width = -2;
  expect(kdray_set_camera(scene, &camera) == KDRAY_INPUT, "a picture of less than nothing");
  expect(kdray_set_camera(scene, NULL) == KDRAY_USAGE, "no camera");
  expect(kdray_set_background(scene, background) == KDRAY_OK, "a background");
  expect(kdray_set_background(scene, negative) == KDRAY_INPUT, "a background below 0");
  expect(kdray_set_ambient(scene, ambient) == KDRAY_OK, "ambient light");
  expect(kdray_set_ambient(scene, NULL) == KDRAY_USAGE, "no ambient light");
  expect(kdray_commit(scene, NULL) == KDRAY_OK, "commit");
  expect_colors(scene, lit, "a box that is lit from above");
  camera.from[2] = -4, camera.ortho_width = 2;
  expect(kdray_set_camera(scene, &camera) == KDRAY_OK, "another camera");
  expect(kdray_set_background(scene, dark) == KDRAY_OK && kdray_set_ambient(scene, dark) == KDRAY_OK,
         "darkness");
  expect(kdray_commit(scene, NULL) == KDRAY_OK, "commit again");
  expect_colors(scene, from_below, "its lower side in the dark");
  kdray_scene_free(scene);
}

/* The box in the middle of a picture two wide, by parallel rays. */
static void commit_seen_from_above(kdray_scene* scene) {
  kdray_camera camera = {0};
  camera.size = sizeof camera;
  camera.from[0] = camera.from[1] = camera.at[0] = camera.at[1] = 0.5, camera.from[2] = 4;
  camera.ortho_width = 2;
  expect(kdray_set_camera(scene, &camera) == KDRAY_OK, "a camera");
  expect(kdray_commit(scene, NULL) == KDRAY_OK, "commit");
}

/* Red by a picture, before a grey that is the middle of a gradient from below to above. */
static void check_textures(void) {
  const unsigned char red[3] = {255, 0, 0};
  const float white[3] = {1, 1, 1}, stops[6] = {0, 0, 0, 1, 1, 1}, uv[16] = {0.5f, 0.5f};
  const double heights[2] = {-1, 1}, upwards[2] = {1, -1};
  const float seen[2][3] = {{0.5f, 0.5f, 0.5f}, {0.5f, 0, 0}};
  kdray_in none = {0}, triangles = {faces, 12, 0, KDRAY_UINT32};
  kdray_scene* scene = NULL;
  kdray_pixels pixels = {0};
  kdray_material material = {0};
  kdray_geometry_options options = {0};
  uint32_t picture = 0;
  pixels.size = sizeof pixels, pixels.data = red, pixels.width = pixels.height = 1, pixels.channels = 3;
  material.size = sizeof material, options.size = sizeof options;
  expect(kdray_scene_new(&scene) == KDRAY_OK, "a scene");
  expect(kdray_add_picture(scene, &pixels, &picture) == KDRAY_OK && picture == 1, "a picture of one pixel");
  pixels.channels = 5;
  expect(kdray_add_picture(scene, &pixels, NULL) != KDRAY_OK, "a picture of five channels");
  expect(kdray_add_picture_file(scene, "there is none.png", NULL) != KDRAY_OK, "a picture of no file");
  material.ambient[0] = material.ambient[1] = material.ambient[2] = 0.5f, material.picture = 7;
  expect(kdray_add_material(scene, &material, &options.material) != KDRAY_OK, "no such picture");
  material.picture = picture;
  expect(kdray_add_material(scene, &material, &options.material) == KDRAY_OK, "a material");
  options.texcoords = floats(uv, 8);
  expect(kdray_add_mesh(scene, floats(corners, 8), triangles, none, &options, NULL) == KDRAY_OK, "a mesh");
  expect(kdray_set_ambient(scene, white) == KDRAY_OK, "ambient light");
  expect(kdray_set_gradient(scene, upwards, stops, 2, NULL) != KDRAY_OK, "a gradient from above to below");
  expect(kdray_set_gradient(scene, heights, stops, 2, NULL) == KDRAY_OK, "a gradient");
  expect(kdray_set_environment(scene, "there is none.exr", NULL, 0, 1) != KDRAY_OK, "no environment");
  commit_seen_from_above(scene);
  expect_colors(scene, seen, "a red box before grey");
  kdray_scene_free(scene);
}

/* Rough everywhere and metal nowhere, by a picture of one pixel: a tenth of the base colour is ambient. */
static void check_metal(void) {
  const unsigned char rough[3] = {0, 255, 255}, half[3] = {51, 0, 0};
  const float white[3] = {1, 1, 1}, dark[3] = {0, 0, 0}, uv[16] = {0.5f, 0.5f};
  const float seen[2][3] = {{0, 0, 0}, {0.05f * 0.6f, 0.05f * 0.6f, 0.05f * 0.6f}};
  kdray_in none = {0}, triangles = {faces, 12, 0, KDRAY_UINT32};
  kdray_scene* scene = NULL;
  kdray_pixels pixels = {0};
  kdray_material material = {0};
  kdray_geometry_options options = {0};
  kdray_light light = {0};
  pixels.size = sizeof pixels, pixels.data = rough, pixels.width = pixels.height = 1, pixels.channels = 3;
  material.size = sizeof material, options.size = sizeof options;
  light.size = sizeof light, light.kind = KDRAY_DIRECTIONAL_LIGHT, light.direction[2] = 1;
  expect(kdray_scene_new(&scene) == KDRAY_OK, "a scene");
  expect(kdray_add_picture(scene, &pixels, &material.metal_picture) == KDRAY_OK, "a picture of metal");
  pixels.data = half;
  expect(kdray_add_picture(scene, &pixels, &material.occlusion_picture) == KDRAY_OK, "one of occlusion");
  material.diffuse[0] = material.diffuse[1] = material.diffuse[2] = 0.5f, material.metallic = -0.5f;
  expect(kdray_add_material(scene, &material, NULL) != KDRAY_OK, "a negative factor");
  material.metallic = KDRAY_FACTOR_0, material.occlusion = 0.5f;
  expect(kdray_add_material(scene, &material, &options.material) == KDRAY_OK, "a material");
  options.texcoords = floats(uv, 8);
  expect(kdray_add_mesh(scene, floats(corners, 8), triangles, none, &options, NULL) == KDRAY_OK, "a mesh");
  expect(kdray_add_light(scene, &light) == KDRAY_OK, "a light from below");
  expect(kdray_set_ambient(scene, white) == KDRAY_OK && kdray_set_background(scene, dark) == KDRAY_OK,
         "ambient light alone");
  commit_seen_from_above(scene);
  expect_colors(scene, seen, "a rough box of no metal");
  kdray_scene_free(scene);
}

/* A box seen twice, and moved; and what has no inverse. */
static void check_instances(void) {
  double places[24] = {1, 0, 0, 5, 0, 1, 0, 0, 0, 0, 1, 0, 1, 0, 0, 9, 0, 1, 0, 0, 0, 0, 1, 1};
  const double flat[12] = {1};
  const double origins[6] = {5.25, 0.5, 5, 9.25, 0.5, 5}, down[3] = {0, 0, -1};
  kdray_in none = {0}, triangles = {faces, 12, 0, KDRAY_UINT32};
  kdray_scene* scene = NULL;
  kdray_geometry_options options = {0};
  kdray_instance_options of_both = {0};
  kdray_rays rays = {0};
  kdray_hits hits = {0};
  double t[2];
  kdray_all_hits* all = NULL;
  kdray_all_hits_view view = {0};
  uint32_t box, both = 99, geometry[2], instance[2];
  int refitted = 0;
  options.size = sizeof options, options.prototype = 1;
  of_both.size = sizeof of_both, of_both.name = "both";
  expect(kdray_scene_new(&scene) == KDRAY_OK, "a scene");
  expect(kdray_add_mesh(scene, floats(corners, 8), triangles, none, &options, &box) == KDRAY_OK,
         "a prototype");
  expect(kdray_add_instances(scene, box, doubles(flat, 1), NULL, NULL) == KDRAY_INPUT, "a flat instance");
  expect(strstr(kdray_last_error(), "transforms[0]") != NULL, "the transform is named");
  expect(kdray_add_instances(scene, 7, doubles(places, 2), NULL, NULL) == KDRAY_USAGE, "no prototype");
  expect(kdray_add_instances(scene, box, doubles(places, 2), &of_both, &both) == KDRAY_OK, "instances");
  expect(kdray_commit(scene, NULL) == KDRAY_OK, "commit");
  rays.size = sizeof rays, rays.origins = doubles(origins, 2), rays.directions = doubles(down, 1);
  hits.size = sizeof hits;
  hits.t.data = t, hits.t.count = 2, hits.t.type = KDRAY_FLOAT64;
  hits.geometry.data = geometry, hits.geometry.count = 2, hits.geometry.type = KDRAY_UINT32;
  hits.instance.data = instance, hits.instance.count = 2, hits.instance.type = KDRAY_UINT32;
  expect(kdray_closest(scene, &rays, &hits, NULL) == KDRAY_OK, "closest");
  expect(t[0] == 4 && t[1] == 3 && geometry[0] == both && geometry[1] == both, "instances are hit");
  expect(instance[0] == 0 && instance[1] == 1, "they are told apart");
  view.size = sizeof view;
  expect(kdray_all(scene, &rays, 0, NULL, &all) == KDRAY_OK && kdray_all_hits_get(all, &view) == KDRAY_OK &&
             view.splits[2] == 4 && view.instance[1] == 0 && view.instance[2] == 1,
         "all hits of instances");
  kdray_all_hits_free(all);
  expect(kdray_update_transforms(scene, both, doubles(places, 1)) == KDRAY_INPUT, "too few transforms");
  places[11] = 2;
  expect(kdray_update_transforms(scene, both, doubles(places, 2)) == KDRAY_OK, "other transforms");
  expect(kdray_commit(scene, NULL) == KDRAY_OK && kdray_last_commit(scene, &refitted, NULL) == KDRAY_OK,
         "commit again");
  expect(refitted == 1 && kdray_closest(scene, &rays, &hits, NULL) == KDRAY_OK && t[0] == 2, "it has moved");
  kdray_scene_free(scene);
}

/* A ring, met four times in the plane of its circle, and not at all through its hole. */
static void check_tori(void) {
  const double center[3] = {0, 0, 0}, axis[3] = {0, 0, 3}, major = 4, minor = 0.5;
  const double origins[6] = {9, 0, 0, 0, 0, 5}, directions[6] = {-1, 0, 0, 0, 0, -1};
  kdray_in one = doubles(center, 1), about = doubles(axis, 1), none = {0};
  kdray_scene* scene = NULL;
  kdray_rays rays = {0};
  kdray_hits hits = {0};
  double t[2];
  uint32_t ring = 9, counts[2];
  const kdray_field disc[3] = {{"normals", about}, {"radii", doubles(&minor, 1)}, {"centers", one}};
  expect(kdray_scene_new(&scene) == KDRAY_OK, "a scene");
  expect(kdray_add_shapes(scene, "cubes", disc, 3, NULL, NULL) == KDRAY_USAGE, "no kind of that name");
  expect(strstr(kdray_last_error(), "spheres, cones, discs, tori, capsules") != NULL,
         "what there is is named");
  expect(kdray_add_shapes(scene, "spheres", disc, 3, NULL, NULL) == KDRAY_USAGE, "spheres have no normals");
  expect(kdray_add_shapes(scene, "discs", disc, 2, NULL, NULL) == KDRAY_INPUT, "no centers");
  expect(kdray_add_shapes(scene, "discs", NULL, 2, NULL, NULL) == KDRAY_USAGE, "no fields");
  expect(kdray_add_tori(scene, one, about, doubles(&minor, 1), doubles(&major, 1), NULL, NULL) == KDRAY_INPUT,
         "a tube wider than its circle");
  expect(strstr(kdray_last_error(), "tori[0]") != NULL, "the torus is named");
  expect(kdray_add_tori(scene, one, none, doubles(&major, 1), doubles(&minor, 1), NULL, NULL) == KDRAY_INPUT,
         "no axes");
  expect(strstr(kdray_last_error(), "axes") != NULL, "the array of axes is named");
  expect(kdray_add_tori(scene, one, about, doubles(&major, 1), doubles(&minor, 1), NULL, &ring) == KDRAY_OK &&
             ring == 0,
         "a torus");
  expect(kdray_add_shapes(scene, "discs", disc, 3, NULL, &ring) == KDRAY_OK && ring == 1,
         "a disc in its hole");
  expect(kdray_remove(scene, ring) == KDRAY_OK, "the disc is removed");
  expect(kdray_add_cones(scene, one, doubles(&minor, 1), about, none, NULL, &ring) == KDRAY_OK,
         "a cone without a radius at its apex");
  expect(kdray_remove(scene, ring) == KDRAY_OK, "the cone is removed");
  expect(kdray_commit(scene, NULL) == KDRAY_OK, "commit");
  rays.size = sizeof rays, rays.origins = doubles(origins, 2), rays.directions = doubles(directions, 2);
  hits.size = sizeof hits, hits.t.data = t, hits.t.count = 2, hits.t.type = KDRAY_FLOAT64;
  expect(kdray_closest(scene, &rays, &hits, NULL) == KDRAY_OK, "closest");
  expect(fabs(t[0] - 4.5) < 1e-5 && isinf(t[1]), "a ring is hit, and its hole isn't");
  expect(kdray_count(scene, &rays, (kdray_out){counts, 2, 0, KDRAY_UINT32}, NULL) == KDRAY_OK, "counts");
  expect(counts[0] == 4 && counts[1] == 0, "a ring is crossed four times");
  kdray_scene_free(scene);
}

static void check_cancel_and_picture(const kdray_scene* scene) {
  static float rgb[3 * 16 * 16];
  kdray_picture_options picture = {0};
  kdray_cancel* cancel = NULL;
  picture.size = sizeof picture;
  picture.width = picture.height = 16;
  expect(kdray_render(scene, &picture, rgb, sizeof rgb / sizeof rgb[0]) == KDRAY_OK, "a picture");
  expect(rgb[3 * (8 * 16 + 8)] > 0, "something in the middle of it");
  expect(kdray_render(scene, &picture, rgb, 7) == KDRAY_USAGE, "too few values");
  expect(kdray_cancel_new(&cancel) == KDRAY_OK, "a cancel");
  kdray_cancel_now(cancel);
  {
    const double origin[3] = {0, 0, 5}, down[3] = {0, 0, -1};
    uint32_t n;
    kdray_rays rays = {0};
    kdray_query_options options = {0};
    rays.size = sizeof rays, rays.origins = doubles(origin, 1), rays.directions = doubles(down, 1);
    options.size = sizeof options, options.cancel = cancel;
    expect(kdray_count(scene, &rays, (kdray_out){&n, 1, 0, KDRAY_UINT32}, &options) == KDRAY_CANCELLED,
           "cancelled");
  }
  kdray_cancel_free(cancel);
}

static void check_refit(kdray_scene* scene, uint32_t box) {
  float moved[24];
  double growth = 0;
  int i, refitted = 9;
  kdray_in none = {0};
  kdray_commit_options options = {0};
  for (i = 0; i < 24; ++i) moved[i] = 1.25f * corners[i];
  expect(kdray_last_commit(scene, &refitted, &growth) == KDRAY_OK && refitted == 0 && growth == 1, "built");
  expect(kdray_update_vertices(scene, box, floats(moved, 8), none) == KDRAY_OK, "moved vertices");
  expect(kdray_commit(scene, NULL) == KDRAY_OK, "a second commit");
  expect(kdray_last_commit(scene, &refitted, &growth) == KDRAY_OK && refitted == 1 && growth < 1.5,
         "refitted");
  options.size = sizeof options, options.refit_growth = -1;
  expect(kdray_commit(scene, &options) == KDRAY_OK, "a third commit");
  expect(kdray_last_commit(scene, &refitted, NULL) == KDRAY_OK && refitted == 0,
         "built because it is asked for");
}

/* Two triangles that floats of a scene this wide have at one height: the upper one comes later. */
static void check_double_geometry(void) {
  const double places[18] = {-5e5, -5e5, 0.3,          5e5, -5e5, 0.3,          0, 5e5, 0.3,
                             -5e5, -5e5, 0.3000000001, 5e5, -5e5, 0.3000000001, 0, 5e5, 0.3000000001};
  const uint32_t numbers[6] = {0, 1, 2, 3, 4, 5};
  const double from[3] = {7, 9, 5}, down[3] = {0, 0, -1};
  double t = 0;
  uint32_t primitive = 9;
  kdray_scene* scene = NULL;
  kdray_in none = {0}, triangles = {numbers, 2, 0, KDRAY_UINT32}, vertices = {places, 6, 0, KDRAY_FLOAT64};
  kdray_in origin = {from, 1, 0, KDRAY_FLOAT64}, direction = {down, 1, 0, KDRAY_FLOAT64};
  kdray_out t_out = {&t, 1, 0, KDRAY_FLOAT64}, primitive_out = {&primitive, 1, 0, KDRAY_UINT32};
  kdray_rays rays = {0};
  kdray_hits hits = {0};
  kdray_commit_options options = {0};
  options.size = sizeof options, options.geometry = 3;
  rays.size = sizeof rays, rays.origins = origin, rays.directions = direction;
  hits.size = sizeof hits, hits.t = t_out, hits.primitive = primitive_out;
  expect(kdray_scene_new(&scene) == KDRAY_OK, "a scene of doubles");
  expect(kdray_add_mesh(scene, vertices, triangles, none, NULL, NULL) == KDRAY_OK, "its mesh");
  expect(kdray_commit(scene, &options) != KDRAY_OK, "a geometry that there is none of is refused");
  options.geometry = 1;
  expect(kdray_commit(scene, &options) == KDRAY_OK, "its commit");
  expect(kdray_closest(scene, &rays, &hits, NULL) == KDRAY_OK && primitive == 1,
         "the upper of two triangles");
  expect(t > 4.6999999998 && t < 4.69999999995, "t in double");
  kdray_scene_free(scene);
}

/* Each option gets through: wrong ones are told, and a file that smooths and has a root is read. */
static void check_loading(const char* box) {
  kdray_scene* scene = NULL;
  kdray_load_options options = {0};
  const double never = NAN;
  options.size = sizeof options;
  options.smooth_degrees = 200;
  expect(kdray_scene_load(box, &options, &scene) == KDRAY_USAGE, "an angle of 200 degrees");
  options.smooth_degrees = 40;
  options.asset_root = "no/such/folder";
  expect(kdray_scene_load(box, &options, &scene) == KDRAY_USAGE, "a root that is no folder");
  options.asset_root = "/";
  options.time = &never;
  expect(kdray_scene_load(box, &options, &scene) == KDRAY_USAGE, "a time that is none");
  options.time = NULL;
  options.animation = "walk";
  expect(kdray_scene_load(box, &options, &scene) == KDRAY_USAGE, "an animation without a time");
  options.animation = NULL;
  options.instances = KDRAY_INSTANCES_FLAT;
  expect(kdray_scene_load(box, &options, &scene) == KDRAY_OK, "a file with options");
  kdray_scene_free(scene);
}

int main(int argc, char** argv) {
  kdray_scene* scene = NULL;
  kdray_in none = {0}, triangles = {faces, 12, 0, KDRAY_UINT32};
  uint32_t box = 9;
  kdray_status status;
  expect(kdray_version() > 0, "a version");
  expect(kdray_scene_new(&scene) == KDRAY_OK, "a scene");
  expect(kdray_add_mesh(scene, floats(corners, 8), triangles, none, NULL, &box) == KDRAY_OK && box == 0,
         "a mesh");
  check_what_is_wrong(scene);
  if (argc > 1) check_loading(argv[1]);
  status = kdray_commit(scene, NULL);
  if (status == KDRAY_NO_DEVICE) return puts("no OpenCL device: skipped"), 0;
  expect(status == KDRAY_OK, "commit");
  check_names();
  check_answers(scene, box);
  check_cancel_and_picture(scene);
  check_looks();
  check_textures();
  check_metal();
  check_instances();
  check_tori();
  check_refit(scene, box);
  check_double_geometry();
  expect(kdray_keep_programs() == KDRAY_OK, "programs are kept");
  kdray_scene_free(scene);
  puts(failures == 0 ? "c_interface: all right" : "c_interface: wrong answers");
  return failures == 0 ? 0 : 1;
}
