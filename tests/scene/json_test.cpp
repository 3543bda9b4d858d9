#include <fmt/format.h>

#include <cmath>

#include "base/local_space.h"
#include "scene/import/load.h"
#include "scene/model/frame.h"
#include "scene/scratch.h"

namespace kdray::scene {
namespace {

using test::refusal;
using test::ScratchFolder;

Scene read(const std::string& text) {
  return read_json(text, "s.json");
}
std::string refused(const std::string& text) {
  return refusal([&] { read(text); });
}
std::string refused_object(const std::string& object) {
  return refused(R"({"objects": [)" + object + "]}");
}

TEST(Json, ReadsAWholeScene) {
  const Scene s = read(R"({
    "kdray": 1,
    "camera": {"from": [0, 1, 9], "at": [0, 1, 0], "up": [1, 0, 0], "fov": 60, "hither": 0.5},
    "background": [0.1, 0.2, 0.3], "ambient": 0.5,
    "render": {"size": [320, 200], "depth": 7, "samples": 4, "min_weight": 0},
    "materials": {"glass": {"color": [0.5, 1, 1], "ka": 0, "kd": 0.5, "ks": 0.4, "shine": 50, "reflect": 0.25,
                            "transmit": 0.75, "index": 1.5, "emission": [0, 0, 2]}},
    "lights": [{"type": "point", "position": [1, 2, 3], "color": 0.5, "attenuation": [0, 1, 2], "range": 30},
               {"type": "directional", "direction": [0, -2, 0], "color": [1, 0, 0]},
               {"type": "spot", "position": [4, 5, 6], "direction": [3, 0, 4], "inner": 60, "outer": 90}],
    "objects": [{"type": "sphere", "center": [1, 2, 3], "radius": 4, "material": "glass"},
                {"type": "cone", "base": [0, 0, 0], "base_radius": 1, "apex": [0, 5, 0]},
                {"type": "triangles", "vertices": [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]],
                 "faces": [[0, 1, 2, 3]], "normals": [[0, 0, 2], [0, 0, 1], [0, 0, 1], [0, 3, 4]],
                 "material": {"color": [1, 0, 0]}}]})");
  ASSERT_TRUE(s.camera);
  EXPECT_EQ(s.camera->from, dvec3(0, 1, 9));
  EXPECT_EQ(s.camera->up, dvec3(1, 0, 0));
  EXPECT_DOUBLE_EQ(s.camera->vertical_fov, std::acos(-1.0) / 3);
  EXPECT_EQ(s.camera->hither, 0.5);
  EXPECT_EQ(s.background, vec3(0.1f, 0.2f, 0.3f));
  EXPECT_EQ(s.ambient, vec3(0.5f));
  EXPECT_EQ(s.settings.width, 320);
  EXPECT_EQ(s.settings.height, 200);
  EXPECT_EQ(s.settings.depth, 7);
  EXPECT_EQ(s.settings.samples, 4);
  EXPECT_EQ(s.settings.min_weight, 0.0);

  ASSERT_EQ(s.lights.size(), 3u);
  EXPECT_EQ(s.lights[0].kind, LightKind::point);
  EXPECT_EQ(s.lights[0].attenuation, dvec3(0, 1, 2));
  EXPECT_EQ(s.lights[0].range, 30);
  EXPECT_EQ(s.lights[0].color, vec3(0.5f));
  EXPECT_EQ(s.lights[1].kind, LightKind::directional);
  EXPECT_EQ(s.lights[1].direction, dvec3(0, -1, 0));
  EXPECT_EQ(s.lights[2].kind, LightKind::spot);
  EXPECT_LT(glm::length(s.lights[2].direction - dvec3(0.6, 0, 0.8)), 1e-15);
  EXPECT_NEAR(s.lights[2].cos_inner, 0.5, 1e-6);
  EXPECT_NEAR(s.lights[2].cos_outer, 0, 1e-6);
  EXPECT_TRUE(std::isinf(s.lights[2].range));

  ASSERT_EQ(s.primitive_count(), 4u);
  const Material& glass = s.materials[s.spheres[0].material];
  EXPECT_EQ(glass.ambient, vec3(0));
  EXPECT_EQ(glass.diffuse, vec3(0.25f, 0.5f, 0.5f));
  EXPECT_EQ(glass.specular, vec3(0.4f));
  EXPECT_EQ(glass.reflect, vec3(0.25f));
  EXPECT_EQ(glass.transmit, vec3(0.375f, 0.75f, 0.75f));
  EXPECT_EQ(glass.emission, vec3(0, 0, 2));
  EXPECT_EQ(glass.shine, 50);
  EXPECT_EQ(glass.index, 1.5f);
  EXPECT_EQ(s.cones[0].number, 1u);
  EXPECT_EQ(s.cones[0].apex_radius, 0);
  EXPECT_EQ(s.triangles[1].number, 3u);
  EXPECT_EQ(s.normals[s.triangles[1].normal[2]], vec3(0, 0.6f, 0.8f));
  EXPECT_EQ(s.materials[s.triangles[0].material].diffuse, vec3(0.9f, 0, 0));
  EXPECT_EQ(s.materials.size(), 3u);
}

TEST(Json, ColoursMayBeWrittenAsTheWebDoes) {
  const Scene s = read(
      R"({"background": "#f00", "ambient": "#808080",
          "lights": [{"type": "point", "position": [0, 0, 9], "color": "white"}],
                           "objects": [{"type": "sphere", "center": [0, 0, 0], "radius": 1,
                                        "material": {"color": "lime", "ka": 0, "kd": 0.5}}]})");
  EXPECT_EQ(s.background, vec3(1, 0, 0));
  EXPECT_NEAR(s.ambient.y, 0.2158605, 1e-6);  // 128 of 255 in sRGB, as linear light
  EXPECT_EQ(s.lights[0].color, vec3(1));
  EXPECT_EQ(s.materials.back().diffuse, vec3(0, 0.5, 0));
}

// A plane without end is made to reach a hundred times as far as all else.
TEST(Json, ACameraThatIsMadeUpLooksAtWhatStandsOnAPlane) {
  const auto seen = [](const std::string& plane, const std::string& others) {
    Scene s = read(R"({"objects": [)" + plane + others + "]}");
    frame_scene(s);
    return s;
  };
  const std::string balls = R"({"type": "sphere", "center": [0, 1, 0], "radius": 1},
                               {"type": "sphere", "center": [3, 1, 0], "radius": 1})";
  const std::string plane = R"({"type": "plane", "point": [0, 0, 0], "normal": [0, 1, 0]})";
  const Scene with = seen(plane + ", ", balls), without = seen("", balls);
  EXPECT_GT(with.bounds().hi.x, 100);
  EXPECT_NEAR(with.framing.box.hi.x, without.framing.box.hi.x, 1e-9);
  EXPECT_LT(glm::length(with.camera->from - without.camera->from), 1);
  EXPECT_FALSE(seen(plane, "").framing.box.empty());
  Scene lit = read(R"({"lights": [{"type": "point", "position": [100, 200, 100]}], "objects": [)" + plane +
                   ", " + balls + "]}");
  frame_scene(lit);
  EXPECT_NEAR(lit.framing.box.hi.x, without.framing.box.hi.x, 1e-9);
  const Scene given =
      seen(R"({"type": "plane", "point": [0, 0, 0], "normal": [0, 1, 0], "extent": 50}, )", balls);
  EXPECT_NEAR(given.framing.box.hi.x, 50, 1e-9);
}

TEST(Json, TakesAnEmptyScene) {
  EXPECT_EQ(read("{}").primitive_count(), 0u);
}

TEST(Json, IncludesMeshesAndPlacesThem) {
  const ScratchFolder folder;
  folder.write("part.nff",
               "f 1 0 0 1 0 1 0 0\np 3\n0 0 0\n1 0 0\n0 1 0\nf 0 1 0 1 0 1 0 0\ns 1 0 0 2\n"
               "pp 3\n0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 1 0\nl 1 1 1\nv from 9 9 9 at 0 0 0 angle 30\n");
  const std::string text = R"({"materials": {"blue": {"color": [0, 0, 1]}}, "objects": [
      {"type": "mesh", "file": "part.nff", "translate": [10, 0, 0], "rotate": [0, 0, 90], "scale": 2},
      {"type": "mesh", "file": "part.nff", "material": "blue",
       "matrix": [0, -2, 0, 10,  2, 0, 0, 0,  0, 0, 2, 0,  0, 0, 0, 1]},
      {"type": "mesh", "file": "part.nff", "rotate": {"axis": [0, 0, 5], "angle": 90}}]})";
  const Scene s = read_json(text, folder / "s.json");
  ASSERT_EQ(s.primitive_count(), 9u);
  EXPECT_FALSE(s.camera) << "a part's camera is not the scene's";
  EXPECT_TRUE(s.lights.empty());
  const auto near = [](const dvec3& a, const dvec3& b) { return glm::length(a - b) < 1e-6; };
  for (const std::size_t part : {0u, 1u}) {  // the same placement in two ways
    const Triangle& t = s.triangles[2 * part];
    EXPECT_TRUE(near(s.vertices[t.vertex[0]], {10, 0, 0}));
    EXPECT_TRUE(near(s.vertices[t.vertex[1]], {10, 2, 0}));
    EXPECT_TRUE(near(s.vertices[t.vertex[2]], {8, 0, 0}));
    EXPECT_TRUE(near(s.spheres[part].center, {10, 2, 0}));
    EXPECT_NEAR(s.spheres[part].radius, 4, 1e-12);
    EXPECT_EQ(s.spheres[part].number, 3 * part + 1);
    EXPECT_TRUE(near(dvec3(s.normals[s.triangles[2 * part + 1].normal[2]]), {-1, 0, 0}));
  }
  EXPECT_TRUE(near(s.vertices[s.triangles[4].vertex[1]], {0, 1, 0}));
  EXPECT_EQ(s.materials[s.triangles[0].material].diffuse, vec3(1, 0, 0));
  EXPECT_EQ(s.materials[s.spheres[0].material].diffuse, vec3(0, 1, 0));
  EXPECT_EQ(s.materials[s.triangles[2].material].diffuse, vec3(0, 0, 0.9f));
  EXPECT_EQ(s.triangles[2].material, s.spheres[1].material);
  EXPECT_EQ(s.triangles[4].material, s.triangles[0].material) << "equal materials are one";
}

TEST(Json, MirrorsKeepFrontsAndSkewsKeepNormalsUpright) {
  for (const char* const scale : {"[-3, 1, 1]", "[-3e-200, 1e-200, 1e-200]", "[-3e200, 1e200, 1e200]",
                                  "[-1e170, 1, 1]", "[-1, 1e-170, 1e100]"}) {
    SCOPED_TRACE(scale);
    const Scene s = read(fmt::format(R"({{"objects": [
        {{"type": "triangles", "vertices": [[0, 0, 0], [1, 0, 1], [0, 1, 0]], "faces": [[0, 1, 2]],
         "normals": [[-1, 0, 1], [-1, 0, 1], [-1, 0, 1]], "scale": {}}}]}})",
                                     scale));
    const Triangle& t = s.triangles[0];
    const dvec3 a = s.vertices[t.vertex[0]], b = s.vertices[t.vertex[1]], c = s.vertices[t.vertex[2]];
    const dvec3 face = glm::normalize(glm::cross(safe_normalize(b - a), safe_normalize(c - a)));
    for (const auto n : t.normal) EXPECT_GT(glm::dot(face, dvec3(s.normals[n])), 1 - 1e-6);
  }
}

TEST(Json, CutsConcaveFaces) {
  const Scene s = read(R"({"objects": [{"type": "triangles", "faces": [[0, 1, 2, 3]],
      "vertices": [[0, 0, 0], [4, -2, 0], [1, 0, 0], [4, 2, 0]]}]})");
  ASSERT_EQ(s.triangles.size(), 2u);
  for (const Triangle& t : s.triangles) {
    const dvec3 n = glm::cross(s.vertices[t.vertex[1]] - s.vertices[t.vertex[0]],
                               s.vertices[t.vertex[2]] - s.vertices[t.vertex[0]]);
    EXPECT_GT(n.z, 0);
  }
}

TEST(Json, NamesTheLineOfWhatIsNotJson) {
  EXPECT_EQ(refused("{\n  \"camera\": {,}\n}").substr(0, 18), "s.json:2: not JSON");
  EXPECT_EQ(refused("").substr(0, 18), "s.json:1: not JSON");
  EXPECT_EQ(refused("{\n\n\"objects\": [").substr(0, 18), "s.json:3: not JSON");
  EXPECT_EQ(refused("{\"ambient\": NaN}").substr(0, 18), "s.json:1: not JSON");
  EXPECT_NE(refused("{\"ambient\": 1e999}").find("s.json:1: 1e999 is beyond"), std::string::npos);
  EXPECT_NE(refused("{\"a\xff\": 1}").find("not JSON"), std::string::npos);
  refused(std::string(1'000'000, '['));
  EXPECT_EQ(refused("{\"objects\":\n" + std::string(5000, '[')),
            "s.json:2: not JSON: the text ends inside of 5001 open brackets; it is cut short, or nested "
            "without an end: "
            "fetch or write it again");
  for (const std::string comment : {"// a", "/* a */", "# a"}) {
    const std::string message = refused("{\"objects\": [] " + comment + "\n}");
    EXPECT_NE(message.find("; JSON has no comments: take them out"), std::string::npos) << message;
  }
  EXPECT_EQ(refused("{\"objects\": [}").find("comments"), std::string::npos);
}

TEST(Json, NamesThePathOfWhatIsNoScene) {
  EXPECT_EQ(refused(R"({"ambient": "gray!"})"),
            "s.json: /ambient: expected a number, [red, green, blue], or a colour as CSS has it, "
            "found \"gray!\"");
  EXPECT_EQ(refused(R"({"ambeint": 1})"), "s.json: /ambeint: unknown key; did you mean 'ambient'?");
  EXPECT_EQ(refused_object(R"({"type": "sphere", "center": [0, 0, 0], "raduis": 1})"),
            "s.json: /objects/0/raduis: unknown key; did you mean 'radius'?");
  EXPECT_EQ(refused(R"({"render": {"xyzzy": 1}})"),
            "s.json: /render/xyzzy: unknown key; known are size depth samples min_weight");
  EXPECT_EQ(refused_object(R"({"type": "sphere", "center": [0, 0, 0]})"),
            "s.json: /objects/0: lacks 'radius'");
  EXPECT_EQ(refused_object(R"({"type": "sphere", "center": [0, 0], "radius": 1})"),
            "s.json: /objects/0/center: expected three numbers [x, y, z], found an array of 2");
  EXPECT_EQ(refused_object(R"({"type": "sphere", "center": [0, 0, 0], "radius": "1"})"),
            "s.json: /objects/0/radius: expected a number, found \"1\"");
  EXPECT_EQ(refused_object(R"({"type": "sphere", "center": [0, 0, 0], "radius": 0})"),
            "s.json: /objects/0/radius: expected a number above 0.0, found 0");
  std::string kinds;
  primitives::for_each_shape([&](auto kind) { kinds += std::string(", ") + kind.kName; });
  EXPECT_EQ(refused_object(R"({"type": "cube"})"),
            "s.json: /objects/0/type: expected one of mesh, triangles, box, cylinder, plane" + kinds +
                ", found \"cube\"");
  EXPECT_EQ(refused(R"({"materials": {"a/b": {"index": 0}}})"),
            "s.json: /materials/a~1b/index: expected a number above 0.0, found 0");
  EXPECT_EQ(refused(R"({"materials": {"red": {}}, "objects": [
                {"type": "sphere", "center": [0, 0, 0], "radius": 1, "material": "rde"}]})"),
            "s.json: /objects/0/material: no material 'rde' in /materials; did you mean 'red'?");
  EXPECT_EQ(refused(R"({"camera": {"from": [0, 0, 1], "at": [0, 0, 0], "fov": 45, "ortho": 3}})"),
            "s.json: /camera/ortho: a camera has either 'fov' or 'ortho'");
  EXPECT_EQ(refused(R"({"camera": {"from": [0, 0, 0], "at": [0, 0, 0]}})"),
            "s.json: /camera: 'from' and 'at' are the same point");
  EXPECT_EQ(refused(R"({"lights": [{"type": "directional", "direction": [0, 0, 0]}]})"),
            "s.json: /lights/0/direction: a direction of [0, 0, 0]");
  EXPECT_EQ(refused(R"({"render": {"size": [640.5, 480]}})"),
            "s.json: /render/size/0: expected a whole number from 1 to 65536, found 640.5");
  EXPECT_EQ(refused(R"({"ambient": -1})"), "s.json: /ambient: a value below 0");
  EXPECT_EQ(refused("[]"), "s.json: the scene: expected an object, found an array of 0");
  EXPECT_EQ(refused(R"({"ambient": 1, "ambient": 2})"),
            "s.json: the key 'ambient' is given twice in one object; remove one");
  EXPECT_EQ(refused(R"({"kdray": 2})"), "s.json: /kdray: expected a whole number from 1 to 1, found 2");
}

TEST(Json, ChecksFacesAgainstTheVertices) {
  const std::string start =
      R"({"type": "triangles", "vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "faces": )";
  for (const char* faces :
       {"[[0, 1, 3]]", "[[0, 1]]", "[[0, 1, -1]]", "[[0, 1, 1.5]]", "[0]", "[[0, 1, \"2\"]]"}) {
    EXPECT_NE(
        refused_object(start + faces + "}").find("/objects/0/faces/0: expected three or more vertex numbers"),
        std::string::npos);
  }
  EXPECT_NE(refused_object(start + R"([[0, 1, 2]], "normals": [[0, 0, 1]]})")
                .find("not one normal for each vertex"),
            std::string::npos);
  EXPECT_NE(refused_object(start + R"([[0, 1, 2]], "normals": [[0, 0, 1], [0, 0, 0], [0, 0, 1]]})")
                .find("a normal without a direction"),
            std::string::npos);
}

TEST(Json, RefusesPlacementsThatMakeNoSense) {
  const ScratchFolder folder;
  folder.write("ball.nff", "f 1 1 1 1 0 1 0 0\ns 0 0 0 1\n");
  const auto placed = [&](const std::string& how) {
    return refusal([&] {
      read_json(R"({"objects": [{"type": "mesh", "file": "ball.nff", )" + how + "}]}", folder / "s.json");
    });
  };
  EXPECT_NE(placed(R"("scale": [1, 2, 1])").find("spheres can be moved"), std::string::npos);
  EXPECT_NE(placed(R"("scale": 0)").find("/objects/0/scale: a scale of 0"), std::string::npos);
  EXPECT_NE(placed(R"("scale": 1, "matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1])").find("keep one kind"),
            std::string::npos);
  EXPECT_NE(placed(R"("matrix": [1,0,0,0, 0,1,0,0, 0,0,0,0, 0,0,0,1])").find("flattens"), std::string::npos);
  EXPECT_NE(placed(R"("matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,2])").find("last row"), std::string::npos);
}

TEST(Json, AListWithoutLightsMeansNone) {
  EXPECT_TRUE(read_json(R"({"lights": []})", "s.json").unlit);
  EXPECT_FALSE(read_json(R"({})", "s.json").unlit);
  EXPECT_FALSE(
      read_json(R"({"lights": [{"type": "directional", "direction": [0, -1, 0]}]})", "s.json").unlit);
}

TEST(Json, RefusesToIncludeItselfAndNamesBadParts) {
  const ScratchFolder folder;
  folder.write("bad.nff", "f 1 1 1 1 0 1 0 0\ns 0 0 0 zero\n");
  const auto include = [&](const std::string& file) {
    return refusal(
        [&] { read_json(R"({"objects": [{"type": "mesh", "file": ")" + file + "\"}]}", folder / "s.json"); });
  };
  EXPECT_NE(include("s.json").find("/objects/0/file: a scene cannot include another .json"),
            std::string::npos);
  EXPECT_NE(include("none.ply").find("/objects/0/file: no file "), std::string::npos);
  EXPECT_NE(include("bad.nff").find("bad.nff:2: expected a sphere's radius, found 'zero'"),
            std::string::npos);
}

}  // namespace
}  // namespace kdray::scene
