/* What    kdray's C interface: scenes of a program's own arrays, queries of rays and points, pictures. It
 *         is what kdray/scene.h is in C++, by the same names, and says there in full what each thing means.
 * Shape   C99. Handles are opaque. A struct begins with its size, so that it can grow: set all of it to 0,
 *         then `size` to sizeof it; what is left 0 or NULL has the default that is named beside it. Arrays
 *         are views of the program's memory: a first element, a count of rows, the bytes from one row to
 *         the next (0: the rows lie one after the other; KDRAY_SAME_ROW: all are the first one) and a type.
 *         count = 0 leaves an array out.
 * Errors  Every function that can fail returns a status, and kdray_last_error() has the message of the
 *         thread's last failure. A call that fails has changed nothing of the scene; answers may be half
 *         written.
 * Threads One thread at a time adds, changes and commits; any number may ask, also while another commits.
 */
#ifndef KDRAY_H
#define KDRAY_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__GNUC__)
#define KDRAY_API __attribute__((visibility("default")))
#else
#define KDRAY_API
#endif

typedef enum kdray_status {
  KDRAY_OK = 0,
  KDRAY_INPUT = 1, /* an array or a file is at fault; the message names it, and the element */
  KDRAY_USAGE = 2,
  KDRAY_NO_DEVICE = 3,
  KDRAY_OUT_OF_MEMORY = 4,
  KDRAY_INTERNAL = 5, /* kdray's own fault */
  KDRAY_CANCELLED = 6
} kdray_status;

typedef enum kdray_type {
  KDRAY_FLOAT32 = 1,
  KDRAY_FLOAT64 = 2,
  KDRAY_UINT32 = 3,
  KDRAY_INT32 = 4,
  KDRAY_UINT64 = 5,
  KDRAY_INT64 = 6,
  KDRAY_UINT8 = 7
} kdray_type;

/* As the stride of what is read: one row, as often as `count` says. */
#define KDRAY_SAME_ROW ((size_t)-1)

/* What is read, and what is written. */
typedef struct kdray_in {
  const void* data;
  size_t count;
  size_t stride; /* in bytes; 0: the rows lie one after the other */
  int32_t type;  /* kdray_type */
} kdray_in;
typedef struct kdray_out {
  void* data;
  size_t count;
  size_t stride;
  int32_t type;
} kdray_out;

#define KDRAY_NO_GEOMETRY 0xffffffffu
#define KDRAY_NO_PRIMITIVE 0xffffffffu

/* Of this thread's last call that failed; "" before any. Valid until the next. */
KDRAY_API const char* kdray_last_error(void);
/* 10000 * major + 100 * minor + patch, of the library that is loaded. */
KDRAY_API uint32_t kdray_version(void);

/* The most memory, in bytes, that this process takes for the texels of pictures that come from now on; what
   is more lies in nameless files ($TMPDIR or /var/tmp). By default half of the memory that is free. */
KDRAY_API void kdray_set_texture_cache(uint64_t bytes);

/* ---- Scenes */

typedef struct kdray_scene kdray_scene;

KDRAY_API kdray_status kdray_scene_new(kdray_scene** scene);

/* What becomes of meshes that a file shows many times: held once where copies would be over a million
 * primitives, copied, or held once. */
typedef enum kdray_instances {
  KDRAY_INSTANCES_AUTOMATIC = 0,
  KDRAY_INSTANCES_FLAT = 1,
  KDRAY_INSTANCES_KEPT = 2
} kdray_instances;

typedef struct kdray_load_options {
  size_t size;
  /* Triangles without normals get them where the surface turns by no more, 0 to 180; 0: they stay flat. */
  double smooth_degrees;
  const double* time;     /* of a glTF file's animation; NULL: nodes are at rest */
  const char* animation;  /* its number or name, or "all"; NULL: the first */
  uint64_t texture_bytes; /* the most that the texels of pictures may take; 0: no limit */
  int32_t instances;      /* kdray_instances */
  const char* asset_root; /* a folder below which it may name files that are not beside it; NULL: none */
} kdray_load_options;

/* A scene file is geometry 0. `options` may be NULL, here and below. */
KDRAY_API kdray_status kdray_scene_load(const char* file, const kdray_load_options* options,
                                        kdray_scene** scene);
/* NULL is no error. */
KDRAY_API void kdray_scene_free(kdray_scene* scene);

typedef struct kdray_geometry_options {
  size_t size;
  const char* name;  /* NULL: none */
  uint32_t mask;     /* 0: every bit. A ray meets the geometry where both masks have a bit in common. */
  uint32_t material; /* of kdray_add_material */
  /* Of meshes: rows of two, one for each vertex; (0, 0) is a picture's upper left corner. count = 0: none */
  kdray_in texcoords;
  int32_t prototype; /* 1: it is seen by its instances alone */
} kdray_geometry_options;

/* `triangles`: rows of three indices (32 or 64 bits); `normals`: count = 0, or one for each vertex.
 * `id` may be NULL, here and below. */
KDRAY_API kdray_status kdray_add_mesh(kdray_scene* scene, kdray_in vertices, kdray_in triangles,
                                      kdray_in normals, const kdray_geometry_options* options, uint32_t* id);
/* Radii: one for each, or one for all. */
KDRAY_API kdray_status kdray_add_spheres(kdray_scene* scene, kdray_in centers, kdray_in radii,
                                         const kdray_geometry_options* options, uint32_t* id);
/* apex_radii: count = 0: pointed. */
KDRAY_API kdray_status kdray_add_cones(kdray_scene* scene, kdray_in bases, kdray_in base_radii,
                                       kdray_in apexes, kdray_in apex_radii,
                                       const kdray_geometry_options* options, uint32_t* id);
KDRAY_API kdray_status kdray_add_discs(kdray_scene* scene, kdray_in centers, kdray_in normals, kdray_in radii,
                                       const kdray_geometry_options* options, uint32_t* id);
/* Rings about `axes`, of any length but 0: 0 < minor < major <= 4096 minor. */
KDRAY_API kdray_status kdray_add_tori(kdray_scene* scene, kdray_in centers, kdray_in axes,
                                      kdray_in major_radii, kdray_in minor_radii,
                                      const kdray_geometry_options* options, uint32_t* id);
/* Shapes of any kind by its plural, an array for each of its fields, which the functions above name:
 * "spheres", "cones", "discs", "tori"; and "capsules", cylinders with round ends, by "starts", "ends" and
 * "radii". */
typedef struct kdray_field {
  const char* name; /* "centers" */
  kdray_in rows;
} kdray_field;
KDRAY_API kdray_status kdray_add_shapes(kdray_scene* scene, const char* kind, const kdray_field* fields,
                                        size_t n_fields, const kdray_geometry_options* options, uint32_t* id);

#define KDRAY_NO_INSTANCE 0xffffffffu
#define KDRAY_OWN_MATERIAL 0xffffffffu

typedef struct kdray_instance_options {
  size_t size;
  const char* name;   /* NULL: none */
  uint32_t mask;      /* of all of them; 0: every bit */
  kdray_in materials; /* uint32: of each in place of the prototype's, or KDRAY_OWN_MATERIAL; one for all */
} kdray_instance_options;

/* Instances of a geometry that was added as a prototype: together one geometry. `transforms`: rows of twelve
 * floats, a matrix of three rows and four columns each, row by row: linear | move. */
KDRAY_API kdray_status kdray_add_instances(kdray_scene* scene, uint32_t prototype, kdray_in transforms,
                                           const kdray_instance_options* options, uint32_t* id);
KDRAY_API kdray_status kdray_update_transforms(kdray_scene* scene, uint32_t instances, kdray_in transforms);

KDRAY_API kdray_status kdray_update_vertices(kdray_scene* scene, uint32_t mesh, kdray_in vertices,
                                             kdray_in normals);
KDRAY_API kdray_status kdray_remove(kdray_scene* scene, uint32_t geometry);
KDRAY_API kdray_status kdray_enable(kdray_scene* scene, uint32_t geometry, int enabled);
/* Of a hit: the name that its file gives the part that was hit, or else its geometry's. Writes as much of it
 * as `size` bytes hold, ending with a 0. (`instance`: KDRAY_NO_INSTANCE where it lies in none.) */
KDRAY_API kdray_status kdray_name_of(const kdray_scene* scene, uint32_t geometry, uint32_t primitive,
                                     uint32_t instance, char* name, size_t size);
/* Here 0 means no bit: no ray meets it. Masks are for rays; points and pictures see every geometry. */
KDRAY_API kdray_status kdray_set_mask(kdray_scene* scene, uint32_t geometry, uint32_t mask);

/* The Whitted terms, each with its colour (red, green, blue) multiplied in. */
typedef struct kdray_material {
  size_t size;
  float emission[3], ambient[3], diffuse[3], specular[3], reflect[3], transmit[3];
  float shine;
  float index; /* of refraction; 0: 1 */
  /* Of kdray_add_picture; 0: none. The first is multiplied by the ambient and diffuse terms and by what goes
   * through, the last by the emission, or by white where that is black. */
  uint32_t picture, normal_picture, emission_picture;
  int32_t alpha; /* kdray_alpha, of `picture` */
  /* As glTF's: green is how rough, blue how metallic, each times its factor. With the first all terms but the
   * emission follow from these and from the base colour, which is `diffuse` times `picture`. The second's
   * red is the share of ambient light that gets there; with `occlusion` below 1 that much of it counts.
   * Factors: 0 to 1, but what is left 0 is 1; KDRAY_FACTOR_0 stands for 0. */
  uint32_t metal_picture, occlusion_picture;
  float metallic, roughness, occlusion;
} kdray_material;
#define KDRAY_FACTOR_0 (-1.0f)
/* What a picture's alpha means: nothing; below a half nothing is there; the share that isn't let through. */
typedef enum kdray_alpha { KDRAY_ALPHA_OPAQUE = 0, KDRAY_ALPHA_MASK = 1, KDRAY_ALPHA_BLEND = 2 } kdray_alpha;
/* Rows from the top; 1 to 4 channels: grey, grey with alpha, red green blue, or these with alpha; codes of
 * sRGB, as files have them. */
typedef struct kdray_pixels {
  size_t size;
  const uint8_t* data;
  uint32_t width, height, channels;
  size_t row_bytes; /* 0: none between rows */
} kdray_pixels;
/* Pictures are numbered from 1. The second reads a PNG or a JPEG. */
KDRAY_API kdray_status kdray_add_picture(kdray_scene* scene, const kdray_pixels* pixels, uint32_t* id);
KDRAY_API kdray_status kdray_add_picture_file(kdray_scene* scene, const char* file, uint32_t* id);
KDRAY_API kdray_status kdray_add_material(kdray_scene* scene, const kdray_material* material, uint32_t* id);

typedef struct kdray_camera {
  size_t size;
  double from[3], at[3], up[3];
  double fov;         /* of the picture's height, in degrees; 0: 45 */
  double ortho_width; /* above 0: orthographic */
  double hither;      /* nothing is seen nearer than this */
  double aperture;    /* above 0: the diameter of a thin lens */
  double focus;       /* how far off, along the view, what is in focus is; 0: as far as `at` */
} kdray_camera;
/* A scene without a camera is seen as a whole, from the front, the right and above. */
KDRAY_API kdray_status kdray_set_camera(kdray_scene* scene, const kdray_camera* camera);

typedef enum kdray_light_kind {
  KDRAY_POINT_LIGHT = 0,
  KDRAY_DIRECTIONAL_LIGHT = 1,
  KDRAY_SPOT_LIGHT = 2,
  KDRAY_RECTANGLE_LIGHT = 3, /* this one and the next two have an area, and throw soft shadows */
  KDRAY_SPHERE_LIGHT = 4,
  KDRAY_DISC_LIGHT = 5
} kdray_light_kind;
typedef struct kdray_light {
  size_t size;
  int32_t kind;          /* kdray_light_kind */
  double position[3];    /* of all but directional lights; the middle of those with an area */
  double direction[3];   /* of directional and spot lights: the way the light travels; all 0: (0, 0, -1) */
  float color[3];        /* red, green, blue; all 0: white */
  double attenuation[3]; /* 1 / (a[0] + a[1]*d + a[2]*d^2); all 0: 1, 0, 0 */
  double range;          /* 0: any distance */
  double inner_degrees, outer_degrees; /* of spot lights: half angles; outer 0: 45 */
  double across[3], down[3];           /* of rectangles: the edges */
  double normal[3];                    /* of discs; all 0: (0, -1, 0) */
  double radius;                       /* of spheres and discs */
} kdray_light;
/* A scene without lights gets some. */
KDRAY_API kdray_status kdray_add_light(kdray_scene* scene, const kdray_light* light);

/* Linear red, green and blue: of what is seen where nothing is, and of light from everywhere. */
KDRAY_API kdray_status kdray_set_background(kdray_scene* scene, const float rgb[3]);
/* Colours by height, the sine of the angle above the horizon, in place of one colour: heights ascend from -1
 * to 1; `rgb` has three for each. `up` NULL: along y. */
KDRAY_API kdray_status kdray_set_gradient(kdray_scene* scene, const double* heights, const float* rgb,
                                          size_t count, const double up[3]);
/* A picture all around (equirectangular EXR, Radiance HDR, PNG or JPEG) in place of one colour: its top lies
 * at `up` (NULL: along y), its middle at -z, turned about `up` by so many degrees; what it shows is
 * multiplied by `strength`. */
KDRAY_API kdray_status kdray_set_environment(kdray_scene* scene, const char* file, const double up[3],
                                             double turn_degrees, double strength);
KDRAY_API kdray_status kdray_set_ambient(kdray_scene* scene, const float rgb[3]);

typedef struct kdray_commit_options {
  size_t size;
  int32_t quality;    /* 0 balanced, 1 fast, 2 best */
  const char* device; /* as --device; NULL: the best there is */
  /* Where only vertices have moved, the tree is fitted to them unless what a ray is expected to cost has
   * grown by more than this since it was built; 0: 1.5; below 0: it is always built. */
  double refit_growth;
  /* 0 float; 1 double: queries answer for vertices and shapes as they were given, exactly; 2: double where
   * the vertices of a scene of meshes without instances are no floats. */
  int32_t geometry;
} kdray_commit_options;
KDRAY_API kdray_status kdray_commit(kdray_scene* scene, const kdray_commit_options* options);

/* What the last commit did: whether the tree was kept and refitted, and by what a ray's expected cost has
 * grown since it was built (or had, where it was built anew for that). Either may be NULL. */
KDRAY_API kdray_status kdray_last_commit(const kdray_scene* scene, int* refitted, double* growth);

/* Writes what the device's compiler has made into kdray's cache folder, so that later processes need not
 * wait for it: takes a second or so, best when there is time. A folder that can't be written is no error. */
KDRAY_API kdray_status kdray_keep_programs(void);

/* ---- Questions */

/* Ends a call of another thread, which then returns KDRAY_CANCELLED. */
typedef struct kdray_cancel kdray_cancel;
KDRAY_API kdray_status kdray_cancel_new(kdray_cancel** cancel);
KDRAY_API void kdray_cancel_now(kdray_cancel* cancel);
KDRAY_API void kdray_cancel_free(kdray_cancel* cancel);

/* One row of an array may serve for all rays. */
typedef struct kdray_rays {
  size_t size;
  kdray_in origins, directions; /* rows of three */
  kdray_in t_min, t_max;        /* count = 0: 0 and infinity */
  kdray_in masks;               /* uint32; count = 0: every bit */
} kdray_rays;

typedef struct kdray_query_options {
  size_t size;
  int32_t invalid_miss; /* 0: a ray or point that means nothing is an error; 1: it misses, and is counted */
  const kdray_cancel* cancel; /* NULL: nobody ends it */
  double radius;              /* of points: how far to look; 0: any distance */
  uint64_t* n_invalid;        /* NULL, or told how many meant nothing */
} kdray_query_options;

/* Of each ray what it hits first; t of rays of doubles is that of this surface in double. */
typedef struct kdray_hits {
  size_t size;
  kdray_out t;                   /* floats of either kind; infinity: a miss */
  kdray_out geometry, primitive; /* uint32 */
  kdray_out u, v;                /* floats */
  kdray_out normal, point;       /* rows of three floats */
  kdray_out instance;            /* uint32: of the geometry, from 0; or KDRAY_NO_INSTANCE */
} kdray_hits;

KDRAY_API kdray_status kdray_closest(const kdray_scene* scene, const kdray_rays* rays, const kdray_hits* hits,
                                     const kdray_query_options* options);
/* hit: uint8, 1 or 0. */
KDRAY_API kdray_status kdray_any(const kdray_scene* scene, const kdray_rays* rays, kdray_out hit,
                                 const kdray_query_options* options);
/* counts: uint32. Every crossing once, at edges and vertices too. Where a ray of doubles begins near a
 * surface, these doubles decide whether it lies ahead. */
KDRAY_API kdray_status kdray_count(const kdray_scene* scene, const kdray_rays* rays, kdray_out counts,
                                   const kdray_query_options* options);

/* All hits: those of ray i are [splits[i], splits[i + 1]). The arrays are the handle's. */
typedef struct kdray_all_hits kdray_all_hits;
typedef struct kdray_all_hits_view {
  size_t size;
  size_t n_rays;
  const uint64_t* splits; /* n_rays + 1 */
  const double* t;
  const uint32_t *geometry, *primitive;
  const float *u, *v;
  const uint8_t* more;      /* of each ray, 1: it has more than max_hits */
  const uint32_t* instance; /* of each hit, as kdray_hits has it */
} kdray_all_hits_view;
/* max_hits: of a ray, the first so many; 0: all. KDRAY_OUT_OF_MEMORY where they don't fit into what is free:
 * the message says how many there are. */
KDRAY_API kdray_status kdray_all(const kdray_scene* scene, const kdray_rays* rays, uint32_t max_hits,
                                 const kdray_query_options* options, kdray_all_hits** hits);
KDRAY_API kdray_status kdray_all_hits_get(const kdray_all_hits* hits, kdray_all_hits_view* view);
KDRAY_API void kdray_all_hits_free(kdray_all_hits* hits);

typedef struct kdray_closest_points_out {
  size_t size;
  kdray_out distance;
  kdray_out point;
  kdray_out geometry, primitive;
  kdray_out u, v;
  kdray_out instance; /* as kdray_hits has it */
} kdray_closest_points_out;
KDRAY_API kdray_status kdray_closest_points(const kdray_scene* scene, kdray_in points,
                                            const kdray_closest_points_out* out,
                                            const kdray_query_options* options);
/* inside: uint8. Points of doubles are decided by these doubles, against triangles exactly (which are floats
 * about the scene's centre). 0 for a point that is not finite. */
KDRAY_API kdray_status kdray_inside(const kdray_scene* scene, kdray_in points, kdray_out inside,
                                    const kdray_query_options* options);
/* distance: floats, negative inside. Of an infinite point infinity, of one with NaN NaN. */
KDRAY_API kdray_status kdray_signed_distance(const kdray_scene* scene, kdray_in points, kdray_out distance,
                                             const kdray_query_options* options);

/* ---- Pictures */

typedef struct kdray_picture_options {
  size_t size;
  int32_t width, height;      /* 0: 1024 */
  int32_t samples;            /* of a pixel; 0: 1 */
  int32_t depth;              /* 0: 5 */
  const kdray_camera* camera; /* NULL: the scene's own */
  const kdray_cancel* cancel;
} kdray_picture_options;
/* rgb: 3 * width * height linear values, from the top left. */
KDRAY_API kdray_status kdray_render(const kdray_scene* scene, const kdray_picture_options* options,
                                    float* rgb, size_t n_values);

#ifdef __cplusplus
}
#endif
#endif
