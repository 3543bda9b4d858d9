/* What    Is a point inside of a closed mesh, and how far is it from the surface: kdray in C.
 * Use     inside MESH X Y Z
 * Errors  Status 1, with kdray's line.
 */
#include <kdray.h>
#include <stdio.h>
#include <stdlib.h>

static void check(kdray_status status) {
  if (status == KDRAY_OK) return;
  fprintf(stderr, "%s\n", kdray_last_error());
  exit(1);
}

int main(int argc, char** argv) {
  if (argc != 5) return fprintf(stderr, "use: inside MESH X Y Z\n"), 2;
  kdray_scene* scene;
  check(kdray_scene_load(argv[1], NULL, &scene));
  const kdray_status status = kdray_commit(scene, NULL);
  if (status == KDRAY_NO_DEVICE) return puts("no OpenCL device: skipped"), 0;
  check(status);
  const double point[3] = {atof(argv[2]), atof(argv[3]), atof(argv[4])};
  double distance, nearest[3];
  uint8_t inside;
  uint32_t primitive;
  const kdray_in points = {point, 1, 0, KDRAY_FLOAT64};
  const kdray_closest_points_out out = {.size = sizeof out,
                                        .distance = {&distance, 1, 0, KDRAY_FLOAT64},
                                        .point = {nearest, 1, 0, KDRAY_FLOAT64},
                                        .primitive = {&primitive, 1, 0, KDRAY_UINT32}};
  check(kdray_closest_points(scene, points, &out, NULL));
  check(kdray_inside(scene, points, (kdray_out){&inside, 1, 0, KDRAY_UINT8}, NULL));
  printf("%s, %g from (%g, %g, %g) on primitive %u\n", inside ? "inside" : "outside", distance, nearest[0],
         nearest[1], nearest[2], primitive);
  kdray_scene_free(scene);
  return 0;
}
