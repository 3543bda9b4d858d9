/* What    A LiDAR sweep over a hilly ground with a few silos, written as PLY points: kdray in C.
 * Use     lidar OUT.ply
 * Errors  Status 1, with kdray's line.
 */
#include <kdray.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { SIDE = 200, BEAMS = 32, TURNS = 1800 };

static void check(kdray_status status) {
  if (status == KDRAY_OK) return;
  fprintf(stderr, "%s\n", kdray_last_error());
  exit(1);
}

static double height(double x, double y) {
  return 3 * sin(0.05 * x) * cos(0.04 * y) + 0.4 * sin(0.31 * x + 0.2 * y);
}

/* A grid of triangles, a metre apart, at coordinates as surveyors have them. */
static const double east = 500000.0, north = 4649776.0;

static uint32_t add_ground(kdray_scene* scene) {
  double* vertices = malloc(sizeof(double) * 3 * SIDE * SIDE);
  uint32_t* triangles = malloc(sizeof(uint32_t) * 6 * (SIDE - 1) * (SIDE - 1));
  uint32_t *t = triangles, id;
  if (!vertices || !triangles) exit(1);
  for (int y = 0; y < SIDE; ++y)
    for (int x = 0; x < SIDE; ++x) {
      double* v = vertices + 3 * (y * SIDE + x);
      v[0] = east + x, v[1] = north + y, v[2] = height(x, y);
    }
  for (uint32_t y = 0; y + 1 < SIDE; ++y)
    for (uint32_t x = 0; x + 1 < SIDE; ++x) {
      const uint32_t a = y * SIDE + x, b = a + 1, c = a + SIDE, d = c + 1;
      *t++ = a, *t++ = b, *t++ = d, *t++ = a, *t++ = d, *t++ = c;
    }
  check(kdray_add_mesh(scene, (kdray_in){vertices, SIDE * SIDE, 0, KDRAY_FLOAT64},
                       (kdray_in){triangles, 2 * (SIDE - 1) * (SIDE - 1), 0, KDRAY_UINT32}, (kdray_in){0},
                       NULL, &id));
  free(vertices);
  free(triangles);
  return id;
}

/* Round silos. */
static uint32_t add_silos(kdray_scene* scene) {
  double bases[15], apexes[15], radius = 4;
  uint32_t id;
  for (int i = 0; i < 5; ++i) {
    const double x = 30 + 35 * i, y = 40 + 27 * i;
    bases[3 * i] = apexes[3 * i] = east + x, bases[3 * i + 1] = apexes[3 * i + 1] = north + y;
    bases[3 * i + 2] = height(x, y) - 3, apexes[3 * i + 2] = height(x, y) + 9;
  }
  const kdray_in radii = {&radius, 1, 0, KDRAY_FLOAT64};
  check(kdray_add_cones(scene, (kdray_in){bases, 5, 0, KDRAY_FLOAT64}, radii,
                        (kdray_in){apexes, 5, 0, KDRAY_FLOAT64}, radii, NULL, &id));
  return id;
}

int main(int argc, char** argv) {
  if (argc != 2) return fprintf(stderr, "use: lidar OUT.ply\n"), 2;
  kdray_scene* scene;
  check(kdray_scene_new(&scene));
  const uint32_t ground = add_ground(scene), silos = add_silos(scene);
  const kdray_status status = kdray_commit(scene, NULL);
  if (status == KDRAY_NO_DEVICE) return puts("no OpenCL device: skipped"), 0;
  check(status);

  /* One scanner, 12 m above the middle, whose beams turn around the vertical. */
  const size_t n = BEAMS * TURNS;
  const double pi = 3.14159265358979323846;
  double origin[3] = {east + SIDE / 2, north + SIDE / 2, height(SIDE / 2, SIDE / 2) + 12};
  double* directions = malloc(sizeof(double) * 3 * n);
  double* points = malloc(sizeof(double) * 3 * n);
  uint32_t* geometry = malloc(sizeof(uint32_t) * n);
  if (!directions || !points || !geometry) return 1;
  for (size_t i = 0; i < n; ++i) {
    const double turn = 2 * pi * (double)(i / BEAMS) / TURNS,
                 down = pi / 180 * (3 + 1.2 * (double)(i % BEAMS));
    directions[3 * i] = cos(turn) * cos(down), directions[3 * i + 1] = sin(turn) * cos(down);
    directions[3 * i + 2] = -sin(down);
  }
  const kdray_rays rays = {.size = sizeof rays,
                           .origins = {origin, 1, 0, KDRAY_FLOAT64},
                           .directions = {directions, n, 0, KDRAY_FLOAT64}};
  const kdray_hits hits = {.size = sizeof hits,
                           .geometry = {geometry, n, 0, KDRAY_UINT32},
                           .point = {points, n, 0, KDRAY_FLOAT64}};
  check(kdray_closest(scene, &rays, &hits, NULL));

  size_t n_hits = 0, n_silos = 0;
  for (size_t i = 0; i < n; ++i) n_hits += geometry[i] != KDRAY_NO_GEOMETRY, n_silos += geometry[i] == silos;
  FILE* out = fopen(argv[1], "w");
  if (!out) return perror(argv[1]), 1;
  fprintf(
      out,
      "ply\nformat ascii 1.0\nelement vertex %zu\nproperty double x\nproperty double y\nproperty double z\n"
      "property uchar geometry\nend_header\n",
      n_hits);
  for (size_t i = 0; i < n; ++i)
    if (geometry[i] != KDRAY_NO_GEOMETRY)
      fprintf(out, "%.4f %.4f %.4f %u\n", points[3 * i], points[3 * i + 1], points[3 * i + 2], geometry[i]);
  if (fclose(out) != 0) return perror(argv[1]), 1;
  printf("%zu beams, %zu points, %zu of them on silos (geometry %u; the ground is %u)\n", n, n_hits, n_silos,
         silos, ground);
  free(directions), free(points), free(geometry);
  kdray_scene_free(scene);
  return 0;
}
