// What    glTF 2.0, .gltf and .glb: the default scene's meshes, lights and cameras, placed by their nodes;
//         the first camera is the one that is looked through. All of it at rest, or at a second of an
//         animation.
// Errors  A node that has two parents, or is its own ancestor, refuses the file; so does all that the parts'
//         headers name.
// Source  Khronos Group, "glTF 2.0 Specification", 2021; KHR_lights_punctual.
#include <glm/gtc/quaternion.hpp>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "scene/import/gltf/gltf_accessor.h"
#include "scene/import/gltf/gltf_document.h"
#include "scene/import/gltf/gltf_lights.h"
#include "scene/import/gltf/gltf_mesh.h"
#include "scene/import/gltf/gltf_pose.h"
#include "scene/import/load.h"

namespace kdray::scene {

namespace gltf {
namespace {

class Reader {
 public:
  Reader(std::string_view text, const std::filesystem::path& path, const LoadOptions& options)
      : document_(text, path),
        meshes_(document_, scene_, names_),
        pose_(document_, options),
        at_rest_(!options.time) {}

  Scene read() {
    visited_.assign(document_.entries("nodes").size(), false);
    read_nodes();
    read_uses();
    for (const std::string& what : document_.warnings()) meshes_.warn(what);
    for (const std::string& what : pose_.warnings()) meshes_.warn(what);
    for (const std::string& what : left_out_of(document_, at_rest_)) meshes_.warn(what);
    if (n_hidden_ > 0)
      meshes_.warn(std::to_string(n_hidden_) + " hidden nodes (KHR_node_visibility) are left out");
    meshes_.finish();
    scene_.names =
        names_.finish(scene_.primitive_count(), static_cast<std::uint32_t>(scene_.instances.size()));
    expose(scene_);
    aim_cameras(scene_);
    if (!scene_.cameras.empty()) scene_.camera = scene_.cameras.front();
    return std::move(scene_);
  }

 private:
  struct Visit {
    JsonNode node;
    dmat4 to_parent;
  };

  // Depth first, in the file's order, without recursion: nodes may be nested deeper than a stack is.
  void read_nodes() {
    std::vector<Visit> open;
    push(roots(), dmat4(1), open);
    while (!open.empty()) {
      const Visit visit = open.back();
      open.pop_back();
      if (is_hidden(visit.node)) {
        ++n_hidden_;
        continue;
      }
      const dmat4 to_world = visit.to_parent * pose_.local(visit.node);
      read_node(visit.node, to_world);
      if (const auto children = visit.node.find("children")) push(children->elements(), to_world, open);
    }
  }

  void push(const std::vector<JsonNode>& indices, const dmat4& to_parent, std::vector<Visit>& open) {
    for (auto it = indices.rbegin(); it != indices.rend(); ++it) {
      const JsonNode& node = document_.entry("nodes", *it);
      if (visited_[whole(*it)]) {
        throw it->error("node " + std::to_string(whole(*it)) +
                        " comes a second time: it has two parents, or is " + "inside itself");
      }
      visited_[whole(*it)] = true;
      open.push_back({node, to_parent});
    }
  }

  // Returns the nodes of the default scene, or of the first one. Of a file without scenes, which leaves the
  // choice to the viewer, all nodes that are no other's children, as other viewers do.
  std::vector<JsonNode> roots() {
    const auto& scenes = document_.entries("scenes");
    const auto index = document_.root().find("scene");
    if (!index && scenes.empty()) return nodes_without_parent();
    const JsonNode& scene = index ? document_.entry("scenes", *index) : scenes.front();
    const auto nodes = scene.find("nodes");
    return nodes ? nodes->elements() : std::vector<JsonNode>{};
  }

  // Their numbers, as a scene has them.
  std::vector<JsonNode> nodes_without_parent() {
    const auto& nodes = document_.entries("nodes");
    std::vector<bool> is_child(nodes.size(), false);
    for (const JsonNode& node : nodes)
      if (const auto children = node.find("children"))
        for (const JsonNode& child : children->elements())
          if (const std::uint64_t i = whole(child); i < nodes.size()) is_child[i] = true;
    for (std::size_t i = 0; i < nodes.size(); ++i)
      if (!is_child[i]) root_numbers_.push_back(i);
    return JsonNode(root_numbers_, document_.file()).elements();
  }

  // KHR_node_visibility: a node that is not visible hides all below it.
  static bool is_hidden(const JsonNode& node) {
    const auto visibility = extension(node, "KHR_node_visibility");
    const auto visible = visibility ? visibility->find("visible") : std::nullopt;
    return visible && !visible->boolean();
  }

  void read_node(const JsonNode& node, const dmat4& to_world) {
    if (const auto mesh = node.find("mesh")) use_mesh(*mesh, node, to_world);
    if (const auto camera = node.find("camera")) {
      const auto read = read_camera(document_.entry("cameras", *camera), to_world, scene_.warnings);
      if (read) scene_.cameras.push_back(*read);
    }
    if (const auto light = extension(node, "KHR_lights_punctual")) read_light_of(*light, to_world);
  }

  // A mesh where a node shows it.
  struct Use {
    std::uint64_t mesh;
    dmat4 to_world;
    std::uint32_t name;
  };

  void use_mesh(const JsonNode& index, const JsonNode& node, const dmat4& to_world) {
    const JsonNode& mesh = document_.entry("meshes", index);
    const std::uint64_t number = whole(index);
    used_.try_emplace(number, Used{mesh, 0, {}});
    const Deformation deformation = deformations_.of(node, mesh);
    const std::size_t first = uses_.size();
    add_uses(number, node, to_world, index);
    if (deformation.any())
      for (std::size_t i = first; i < uses_.size(); ++i) deformed_.emplace(i, deformation);
  }

  void add_uses(std::uint64_t number, const JsonNode& node, const dmat4& to_world, const JsonNode& index) {
    const auto many = extension(node, "EXT_mesh_gpu_instancing");
    std::string text = name_of(node);
    if (text.empty()) text = name_of(used_.at(number).mesh);
    const std::uint32_t name = names_.add(text);
    if (!many) return add_use({number, to_world, name}, index);
    for (const dmat4& placed : placements_of(*many)) add_use({number, to_world * placed, name}, index);
  }

  void add_use(const Use& use, const JsonNode& index) {
    if (uses_.size() >= kMaxInstances) throw index.error("2^27 instances or more", "leave some out");
    uses_.push_back(use);
    ++used_.at(use.mesh).n;
  }

  // Source: EXT_mesh_gpu_instancing. What it has besides (_ID, ...) says nothing of shape or place.
  RawVector<dmat4> placements_of(const JsonNode& instancing) {
    const JsonNode attributes = instancing["attributes"];
    std::optional<std::size_t> n;
    const auto accessor = [&](const char* name) -> std::optional<JsonNode> {
      const auto index = attributes.find(name);
      if (!index) return std::nullopt;
      const JsonNode& found = document_.entry("accessors", *index);
      const std::size_t count = accessor_count(found);
      if (n && *n != count) throw attributes.error("attributes of instances that are not equally many");
      n = count;
      return found;
    };
    const auto translation = accessor("TRANSLATION"), rotation = accessor("ROTATION"),
               scale = accessor("SCALE");
    // They are read before there is memory for so many: a count alone is not believed.
    RawVector<std::array<float, 4>> turns;
    RawVector<dvec3> scales, moves;
    if (rotation) {
      if ((*rotation)["type"].string() != "VEC4") throw(*rotation)["type"].expected("VEC4");
      turns = read_colors(document_, *rotation);
    }
    if (scale) scales = read_vectors(document_, *scale);
    if (translation) moves = read_vectors(document_, *translation);
    RawVector<dmat4> all(n.value_or(0));
    for (std::size_t i = 0; i < all.size(); ++i) {
      all[i] = dmat4(1);
      if (!turns.empty()) {
        const glm::dquat q(turns[i][3], turns[i][0], turns[i][1], turns[i][2]);
        if (glm::length(q) > 0) all[i] = glm::mat4_cast(glm::normalize(q));
      }
      for (int k = 0; k < 3 && !scales.empty(); ++k) all[i][k] *= scales[i][k];
      if (!moves.empty()) all[i][3] = glm::dvec4(moves[i], 1);
    }
    return all;
  }

  // Adds what is used, in the order of its use: a mesh that is worth it once, with its instances.
  void read_uses() {
    for (std::size_t i = 0; i < uses_.size(); ++i) {
      const Use& use = uses_[i];
      Used& used = used_.at(use.mesh);
      names_.name_primitives(scene_.primitive_count(), use.name);
      names_.name_instances(static_cast<std::uint32_t>(scene_.instances.size()), use.name);
      if (const auto own = deformed_.find(i); own != deformed_.end()) {
        meshes_.add(used.mesh, use.to_world, own->second);
        continue;
      }
      if (!used.kept) used.kept = worth_keeping(meshes_.count_triangles(used.mesh), used.n);
      Instance instance = instance_of(use.to_world, 0);
      if (!*used.kept || fault_of(instance) != nullptr) {
        meshes_.add(used.mesh, use.to_world);
        continue;
      }
      if (!used.number) {
        used.number = static_cast<std::uint32_t>(scene_.meshes.size());
        scene_.meshes.push_back(std::make_shared<const Scene>(meshes_.alone(used.mesh)));
      }
      instance.mesh = *used.number;
      if (!scene_.meshes[instance.mesh]->triangles.empty()) scene_.instances.push_back(instance);
    }
    uses_ = {};
    deformed_ = {};
  }

  void read_light_of(const JsonNode& reference, const dmat4& to_world) {
    if (lights_.empty()) {
      const auto list = extension(document_.root(), "KHR_lights_punctual");
      if (!list) throw reference.error("the file has no /extensions/KHR_lights_punctual");
      lights_ = (*list)["lights"].elements();
    }
    const std::uint64_t i = whole(reference["light"]);
    if (i >= lights_.size()) throw reference["light"].error("there is no such light");
    scene_.lights.push_back(read_light(lights_[i], to_world));
  }

  Document document_;
  Scene scene_;
  NameTable names_;
  MeshReader meshes_;
  Pose pose_;
  Deformations deformations_{document_, pose_};
  bool at_rest_;
  struct Used {
    JsonNode mesh;
    std::uint64_t n = 0;  // times
    std::optional<bool> kept;
    std::optional<std::uint32_t> number = {};  // among the scene's meshes
  };
  std::map<std::uint64_t, Used> used_;           // by the file's number of the mesh
  PageVector<Use> uses_;                         // in the file's order
  std::map<std::size_t, Deformation> deformed_;  // those of them that have a shape of their own
  std::vector<bool> visited_;
  std::size_t n_hidden_ = 0;
  nlohmann::json root_numbers_ = nlohmann::json::array();  // of a file without scenes
  std::vector<JsonNode> lights_;                           // of the file, once a node asks for one
};

}  // namespace
}  // namespace gltf

Scene read_gltf(std::string_view text, const std::filesystem::path& file, const LoadOptions& options) {
  return gltf::Reader(text, file, options).read();
}
Scene read_gltf(std::string_view text, const std::filesystem::path& file) {
  return read_gltf(text, file, {});
}

}  // namespace kdray::scene
