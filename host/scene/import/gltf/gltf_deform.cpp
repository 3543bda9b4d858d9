#include "scene/import/gltf/gltf_pose.h"

#include <fmt/format.h>

#include <string>

#include "scene/import/gltf/gltf_accessor.h"

namespace kdray::scene::gltf {

Deformation Deformations::of(const JsonNode& node, const JsonNode& mesh) {
  Deformation out{.weights = pose_.weights(node, mesh)};
  if (const auto skin = node.find("skin")) out.joints = joints_of(document_.entry("skins", *skin));
  return out;
}

std::shared_ptr<const std::vector<dmat4>> Deformations::joints_of(const JsonNode& skin) {
  const auto [it, added] = skins_.try_emplace(skin.id());
  if (!added) return it->second;
  const std::vector<JsonNode> nodes = skin["joints"].elements();
  std::vector<dmat4> joints;
  for (const JsonNode& node : nodes) joints.push_back(pose_.to_world(node));
  if (const auto index = skin.find("inverseBindMatrices")) {
    const auto inverse = read_matrices(document_, document_.entry("accessors", *index));
    if (inverse.size() < joints.size())
      throw skin.error(std::to_string(joints.size()) + " joints, but " + std::to_string(inverse.size()) +
                       " inverse bind matrices");
    for (std::size_t i = 0; i < joints.size(); ++i) joints[i] = joints[i] * inverse[i];
  }
  return it->second = std::make_shared<const std::vector<dmat4>>(std::move(joints));
}

VertexMatrices::VertexMatrices(Document& document, const JsonNode& primitive, const Deformation& deformation,
                               const dmat4& to_world)
    : to_world_(to_world), joints_(deformation.joints) {
  if (!joints_) return;
  const JsonNode attributes = primitive["attributes"];
  const std::uint64_t n = accessor_count(document.entry("accessors", attributes["POSITION"]));
  for (std::size_t set = 0; n > 0 && set < kMostJointSets; ++set) {
    const auto joints = attributes.find("JOINTS_" + std::to_string(set)),
               weights = attributes.find("WEIGHTS_" + std::to_string(set));
    if (!joints || !weights) break;
    sets_.push_back({read_quads(document, document.entry("accessors", *joints)),
                     read_quads(document, document.entry("accessors", *weights))});
    if (sets_.back().joints.size() != n || sets_.back().weights.size() != n)
      throw joints->error("joints or weights that are not as many as the " + std::to_string(n) +
                          " positions");
    for (const auto& four : sets_.back().joints)
      for (const double joint : four)
        if (!(joint >= 0 && joint < static_cast<double>(joints_->size())))
          throw joints->error("the skin has " + std::to_string(joints_->size()) +
                              " joints, and a vertex asks for joint " + fmt::format("{:g}", joint));
  }
}

// Weights sum up to 1 but for their rounding. A vertex that no joint holds moves with the node.
dmat4 VertexMatrices::of(std::size_t vertex) const {
  dmat4 sum(0);
  double total = 0;
  for (const Set& set : sets_)
    for (std::size_t i = 0; i < 4; ++i) {
      const double weight = set.weights[vertex][i];
      if (!(weight > 0)) continue;
      sum += weight * (*joints_)[static_cast<std::size_t>(set.joints[vertex][i])];
      total += weight;
    }
  return total > 0 ? sum / total : to_world_;
}

void morph(Document& document, const JsonNode& primitive, std::string_view attribute,
           std::span<const double> weights, RawVector<dvec3>& values) {
  const auto targets = weights.empty() ? std::nullopt : primitive.find("targets");
  if (!targets) return;
  std::size_t i = 0;
  for (const JsonNode& target : targets->elements()) {
    const double weight = i < weights.size() ? weights[i] : 0;
    ++i;
    const auto index = target.find(attribute);
    if (!index || weight == 0) continue;
    const auto offsets = read_vectors(document, document.entry("accessors", *index), NotFinite::nan);
    if (offsets.size() != values.size())
      throw target.error(std::to_string(offsets.size()) + " offsets for " + std::to_string(values.size()) +
                         " vertices");
    for (std::size_t k = 0; k < values.size(); ++k) values[k] += weight * offsets[k];
  }
}

}  // namespace kdray::scene::gltf
