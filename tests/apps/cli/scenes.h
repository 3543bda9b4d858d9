// What    A small scene for the command line's tests: one sphere of known place on a polygon.
#pragma once

namespace kdray::test {

// The primitives are 0 and 1, the square's triangles, and 2, the sphere of radius 1 about (0, 0, 1).
inline constexpr const char* kSphereOnSquare =
    "v\nfrom 0 -6 3\nat 0 0 1\nup 0 0 1\nangle 40\nhither 0.1\nresolution 48 32\n"
    "b 0.1 0.2 0.4\n"
    "l -4 -5 8\n"
    "f 0.8 0.7 0.5 0.9 0.1 10 0 0\n"
    "p 4\n-4 -4 0\n4 -4 0\n4 4 0\n-4 4 0\n"
    "f 0.6 0.6 0.7 0.5 0.4 40 0 0\n"
    "s 0 0 1 1\n";

}  // namespace kdray::test
