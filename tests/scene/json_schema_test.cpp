// What    Holds docs/scene.schema.json against the reader: the same objects, the same keys, the same ones
//         required, and the same defaults. Values for every key are made up from the schema itself, so a key
//         added to one side only fails here.
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <tuple>

#include "scene/import/json/json_keys.h"
#include "scene/import/load.h"
#include "scene/pictures.h"
#include "scene/scratch.h"
#include "support/data.h"

namespace kdray::scene {
namespace {

using nlohmann::json;

json schema() {
  std::ifstream in(test::source_path("docs/scene.schema.json"));
  return json::parse(in);
}

const json& definition(const json& root, const std::string& name) {
  return name == "scene" ? root : root.at("$defs").at(name);
}

std::set<std::string> keys_of(const json& object) {
  std::set<std::string> keys;
  for (const auto& [key, value] : object.items()) keys.insert(key);
  return keys;
}

// A value the schema allows. Numbers are taken low in their range, and vectors so that no direction is 0 and
// no two points of one object are the same.
json example(const json& root, const json& rule, const std::string& key);

json example_object(const json& root, const json& rule) {
  json object = json::object();
  for (const auto& [key, value] : rule.at("properties").items()) object[key] = example(root, value, key);
  if (object.contains("matrix")) object.erase("matrix");  // stands instead of the other three
  if (object.contains("ortho")) object.erase("ortho");    // stands instead of fov
  return object;
}

json example(const json& root, const json& rule, const std::string& key) {
  if (rule.contains("const")) return rule["const"];
  if (key == "vertices" || key == "normals") return json::parse("[[1, 0, 0], [0, 1, 0], [0, 0, 1]]");
  if (key == "faces") return json::parse("[[0, 1, 2]]");
  if (key == "file") return "mesh.nff";
  if (key.ends_with("picture")) return "p.png";
  if (key == "uv") return json::parse("[[0, 0], [1, 0], [0, 1]]");
  if (rule.contains("enum")) return rule["enum"][0];
  if (key == "material") return "m";
  if (key == "materials") return json::object({{"m", example_object(root, definition(root, "material"))}});
  if (key == "at" || key == "apex") return {1, 2, 9};
  if (key == "max") return {4, 5, 9};
  if (key == "minor_radius") return 0.25;  // less than the major one
  if (key == "matrix") return {1, 0, 0, 5, 0, 1, 0, 6, 0, 0, 1, 7, 0, 0, 0, 1};
  if (rule.contains("$ref")) {
    const std::string ref = rule["$ref"];
    return example(root, definition(root, ref.substr(ref.rfind('/') + 1)), key);
  }
  if (rule.contains("oneOf")) return example(root, rule["oneOf"][0], key);
  const std::string type = rule.at("type");
  if (type == "object") return example_object(root, rule);
  if (type == "string") return "text";
  if (type == "array") {
    json array = json::array();
    const int n = rule.value("minItems", 1);
    for (int i = 0; i < n; ++i)
      array.push_back(key == "objects" || key == "lights" || key == "stops" || key == "instances"
                          ? example(root, rule["items"], "")
                          : json(i + 1));
    return array;
  }
  const double low = rule.value("minimum", 1.0);
  return type == "integer" ? json(static_cast<int>(std::max(low, 2.0))) : json(std::max(low, 1.0));
}

// By their fields.
template <class Shape>
void expect_equal(const std::vector<Shape>& a, const std::vector<Shape>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    const auto expect = [&](const auto& field) {
      EXPECT_TRUE(a[i].*field.member == b[i].*field.member) << field.key;
    };
    std::apply([&](const auto&... field) { (expect(field), ...); }, fields_of(a.data()));
  }
}

class Schema : public ::testing::Test {
 protected:
  Schema() {
    folder_.write("mesh.nff", "f 1 1 1 1 0 1 0 0\ns 0 0 0 1\n");
    folder_.write("p.png", test::four_colors());
    folder_.write("sky.hdr", "#?RADIANCE\n\n-Y 1 +X 1\nabcd");
  }

  // A scene around one object of the kind `name`.
  json document_with(const std::string& name, json object) const {
    json document;
    document["materials"]["m"] = json::object();
    if (name == "scene") return object;
    if (name == "camera" || name == "render") {
      document[name] = object;
    } else if (name == "material") {
      document["materials"]["m"] = object;
    } else if (name.ends_with("_light")) {
      document["lights"] = json::array({object});
    } else if (name == "gradient" || name == "sky_picture") {
      document["background"] = object;
      if (object.value("file", json()) == "mesh.nff") document["background"]["file"] = "sky.hdr";
    } else if (name == "stop") {
      document["background"] = {{"type", "gradient"}, {"stops", json::array({object})}};
    } else if (name == "turn") {
      document["objects"] = json::array({json{{"type", "mesh"}, {"file", "mesh.nff"}, {"rotate", object}}});
    } else if (name == "instance") {
      document["objects"] =
          json::array({json{{"type", "mesh"}, {"file", "mesh.nff"}, {"instances", json::array({object})}}});
    } else {
      document["objects"] = json::array({object});
    }
    return document;
  }
  Scene read(const json& document) const { return read_json(document.dump(), folder_ / "s.json"); }

  const json root_ = schema();
  test::ScratchFolder folder_;
};

TEST_F(Schema, ListsTheKeysOfTheReader) {
  std::set<std::string> names;
  for (const JsonKeys& object : json_keys::kAll) {
    const std::string name(object.name);
    names.insert(name);
    const json& rule = definition(root_, name);
    EXPECT_EQ(keys_of(rule.at("properties")), (std::set<std::string>(object.keys.begin(), object.keys.end())))
        << object.name;
    EXPECT_EQ(rule.at("additionalProperties"), false) << object.name;
  }
  for (const auto& [name, rule] : root_.at("$defs").items()) {
    EXPECT_EQ(rule.contains("properties"), names.contains(name))
        << name << ": an object the reader does not know";
  }
}

// Otherwise it is no object of any scene.
TEST_F(Schema, RefersToEachDefinition) {
  const std::string all = root_.dump();
  for (const auto& [name, rule] : root_.at("$defs").items())
    EXPECT_NE(all.find("\"#/$defs/" + name + "\""), std::string::npos) << name;
}

TEST_F(Schema, EveryKeyIsRead) {
  for (const JsonKeys& keys : json_keys::kAll) {
    const std::string name(keys.name);
    const json& rule = definition(root_, name);
    const json full = example_object(root_, rule);
    EXPECT_NO_THROW(read(document_with(name, full))) << name << ": " << full.dump();
    for (const auto& [key, value] : rule.at("properties").items()) {
      json wrong = full;
      wrong[key] = json::parse(R"([[], {}])");  // right for no key: a key the reader skips would let it pass
      if (key == "matrix") wrong.erase("translate"), wrong.erase("rotate"), wrong.erase("scale");
      if (key == "ortho") wrong.erase("fov");
      EXPECT_THROW(read(document_with(name, wrong)), Error) << name << " does not read " << key;
      wrong = full;
      wrong[key + "_"] = 1;
      EXPECT_THROW(read(document_with(name, wrong)), Error) << name << " takes an unknown key";
    }
  }
}

TEST_F(Schema, RequiresWhatTheReaderRequires) {
  for (const JsonKeys& keys : json_keys::kAll) {
    const std::string name(keys.name);
    const json& rule = definition(root_, name);
    const json required = rule.value("required", json::array());
    const json dependent = rule.value("dependentRequired", json::object());
    const json full = example_object(root_, rule);
    for (const auto& [key, value] : full.items()) {
      json less = full;
      less.erase(key);
      bool needed = std::find(required.begin(), required.end(), key) != required.end();
      for (const auto& [other, wanted] : dependent.items())
        needed = needed || std::find(wanted.begin(), wanted.end(), key) != wanted.end();
      if (key == "materials") continue;  // the objects of the example name one
      if (needed) {
        EXPECT_THROW(read(document_with(name, less)), Error) << name << " without " << key;
      } else {
        EXPECT_NO_THROW(read(document_with(name, less))) << name << " without " << key;
      }
    }
  }
}

TEST_F(Schema, TellsTheReadersDefaults) {
  for (const JsonKeys& keys : json_keys::kAll) {
    const std::string name(keys.name);
    const json& rule = definition(root_, name);
    const json full = example_object(root_, rule);
    for (const auto& [key, value] : rule.at("properties").items()) {
      if (!value.contains("default")) continue;
      json with = full, without = full;
      with[key] = value["default"];
      without.erase(key);
      const Scene a = read(document_with(name, with)), b = read(document_with(name, without));
      EXPECT_EQ(a.materials, b.materials) << name << "/" << key;
      EXPECT_EQ(a.background, b.background);
      EXPECT_EQ(a.ambient, b.ambient);
      if (a.camera && b.camera) {
        EXPECT_EQ(a.camera->up, b.camera->up);
        EXPECT_DOUBLE_EQ(a.camera->vertical_fov, b.camera->vertical_fov);
        EXPECT_EQ(a.camera->hither, b.camera->hither);
      }
      ASSERT_EQ(a.lights.size(), b.lights.size());
      for (std::size_t i = 0; i < a.lights.size(); ++i) EXPECT_EQ(a.lights[i].color, b.lights[i].color);
      primitives::for_each_shape(
          [&](auto kind) { expect_equal(decltype(kind)::of(a), decltype(kind)::of(b)); });
    }
  }
}

// docs/scenes.md has an item for each kind of shape, with all its fields.
TEST(ScenesPage, NamesEveryKindAndItsFields) {
  std::ifstream page(std::string(KDRAY_SOURCE_DIR) + "/docs/scenes.md");
  std::map<std::string, std::string> items;  // of lists, by the word they begin with
  std::string word;
  for (std::string line; std::getline(page, line);) {
    if (line.starts_with("- `")) word = line.substr(3, line.find('`', 3) - 3);
    if (!line.starts_with("- `") && !line.starts_with("  ")) word.clear();
    items[word] += line;
  }
  primitives::for_each_shape([&](auto kind) {
    ASSERT_TRUE(items.contains(kind.kName)) << kind.kName;
    const auto expect = [&](const auto& field) {
      EXPECT_NE(items[kind.kName].find("`" + std::string(field.key) + "`"), std::string::npos)
          << kind.kName << ": " << field.key;
    };
    std::apply([&](const auto&... field) { (expect(field), ...); },
               fields_of(static_cast<const typename decltype(kind)::Source*>(nullptr)));
  });
}

}  // namespace
}  // namespace kdray::scene
