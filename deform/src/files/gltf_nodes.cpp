#include "files/gltf_scene.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include "files/gltf_document.hpp"
#include "geometry/usable.hpp"

namespace nendo::deform {

namespace {

using Json = GltfDocument::Json;

std::vector<double> weights_in(const Json& item) {
  std::vector<double> weights;
  const Json* const list = gltf_member(item, "weights");
  if (list == nullptr || !list->is_array()) return weights;
  for (const Json& number : *list) {
    if (!number.is_number() || !is_usable(number.get<double>()))
      throw GltfRefusal{"a weight of a morph target is not a finite number"};
    weights.push_back(number.get<double>());
  }
  return weights;
}

/// The node's own weights, or the mesh's. None if all are 0.
std::vector<double> default_weights(const Json& node, const Json& mesh) {
  const bool has_own = gltf_member(node, "weights") != nullptr;
  auto weights = weights_in(has_own ? node : mesh);
  if (std::all_of(weights.begin(), weights.end(), [](double weight) { return weight == 0.0; }))
    weights.clear();
  return weights;
}

/// Each of these three may be null. The rotation is x, y, z, w.
Eigen::Affine3d transform_by(const double* translation, const double* rotation,
                             const double* scale) {
  Eigen::Affine3d transform = Eigen::Affine3d::Identity();
  if (translation != nullptr) transform.translate(Eigen::Vector3d(translation));
  if (rotation != nullptr) {
    const Eigen::Quaterniond turn(rotation[3], rotation[0], rotation[1], rotation[2]);
    if (turn.norm() > 0.0) transform.rotate(turn.normalized());
  }
  if (scale != nullptr) transform.scale(Eigen::Vector3d(scale));
  return transform;
}

Eigen::Affine3d own_transform(const Json& node) {
  const auto matrix = gltf_numbers(node, "matrix", 16);
  if (!matrix.empty()) {
    Eigen::Affine3d transform = Eigen::Affine3d::Identity();
    const Eigen::Matrix4d given = Eigen::Map<const Eigen::Matrix4d>(matrix.data());
    transform.matrix().topRows<3>() = given.topRows<3>();
    return transform;
  }
  const auto translation = gltf_numbers(node, "translation", 3);
  const auto rotation = gltf_numbers(node, "rotation", 4);
  const auto scale = gltf_numbers(node, "scale", 3);
  const auto data_of = [](const std::vector<double>& numbers) {
    return numbers.empty() ? nullptr : numbers.data();
  };
  return transform_by(data_of(translation), data_of(rotation), data_of(scale));
}

/// The numbers of a list of nodes.
std::vector<std::uint64_t> numbers_in(const GltfDocument& document, const Json& object,
                                      const char* name) {
  std::vector<std::uint64_t> numbers;
  const Json* const list = gltf_member(object, name);
  if (list == nullptr) return numbers;
  for (const Json& number : *list) {
    if (!number.is_number_unsigned())
      throw GltfRefusal{std::string("\"") + name + "\" is not a list of nodes"};
    document.item("nodes", number.get<std::uint64_t>());
    numbers.push_back(number.get<std::uint64_t>());
  }
  return numbers;
}

/// All nodes below those of the scene, each before its children, and where they are.
class NodeTree {
public:
  explicit NodeTree(const GltfDocument& document)
      : document_(document), T_world_node_(document.size_of("nodes"), Eigen::Affine3d::Identity()),
        seen_(T_world_node_.size(), false) {
    walk(roots());
  }

  const std::vector<std::uint64_t>& order() const noexcept { return order_; }
  const Eigen::Affine3d& transform(std::uint64_t node) const {
    return T_world_node_[static_cast<std::size_t>(node)];
  }

private:
  std::vector<std::uint64_t> roots() const {
    if (document_.size_of("scenes") > 0)
      return numbers_in(
          document_, document_.item("scenes", gltf_count(document_.root(), "scene", 0)), "nodes");
    std::vector<bool> is_child(T_world_node_.size(), false);
    for (std::size_t node = 0; node < is_child.size(); ++node)
      for (const std::uint64_t child :
           numbers_in(document_, document_.item("nodes", node), "children"))
        is_child[static_cast<std::size_t>(child)] = true;
    std::vector<std::uint64_t> roots;
    for (std::size_t node = 0; node < is_child.size(); ++node)
      if (!is_child[node]) roots.push_back(node);
    return roots;
  }

  // Without recursion, for a hostile tree may be deep.
  void walk(std::vector<std::uint64_t> waiting) {
    std::reverse(waiting.begin(), waiting.end());
    for (const std::uint64_t root : waiting)
      T_world_node_[static_cast<std::size_t>(root)] = own_transform(document_.item("nodes", root));
    while (!waiting.empty()) {
      const std::uint64_t node = waiting.back();
      waiting.pop_back();
      if (seen_[static_cast<std::size_t>(node)])
        throw GltfRefusal{"node " + std::to_string(node) + " is in the scene twice"};
      seen_[static_cast<std::size_t>(node)] = true;
      order_.push_back(node);
      auto children = numbers_in(document_, document_.item("nodes", node), "children");
      for (auto child = children.rbegin(); child != children.rend(); ++child) {
        T_world_node_[static_cast<std::size_t>(*child)] =
            transform(node) * own_transform(document_.item("nodes", *child));
        waiting.push_back(*child);
      }
    }
  }

  const GltfDocument& document_;
  std::vector<Eigen::Affine3d> T_world_node_;
  std::vector<bool> seen_;
  std::vector<std::uint64_t> order_;
};

std::vector<Eigen::Affine3d> joints_of(const GltfDocument& document, const NodeTree& tree,
                                       std::uint64_t number) {
  const Json& skin = document.item("skins", number);
  std::vector<Eigen::Affine3d> joints;
  for (const std::uint64_t node : numbers_in(document, skin, "joints"))
    joints.push_back(tree.transform(node));
  if (gltf_member(skin, "inverseBindMatrices") == nullptr) return joints;
  const GltfNumbers inverse = document.numbers(gltf_count(skin, "inverseBindMatrices", 0));
  if (inverse.width != 16 || inverse.count < joints.size())
    throw GltfRefusal{"a skin has too few inverseBindMatrices"};
  for (std::size_t joint = 0; joint < joints.size(); ++joint) {
    Eigen::Affine3d bind = Eigen::Affine3d::Identity();
    bind.matrix().topRows<3>() = Eigen::Map<const Eigen::Matrix4d>(inverse.row(joint)).topRows<3>();
    joints[joint] = joints[joint] * bind;
  }
  return joints;
}

constexpr std::size_t max_placed_meshes = 1'000'000;

/// Where the instances of a node's mesh are, relative to the node.
std::vector<Eigen::Affine3d> instances_of(const GltfDocument& document, const Json& instances) {
  const Json* const attributes = gltf_member(instances, "attributes");
  if (attributes == nullptr) throw GltfRefusal{"instances of a mesh have no attributes"};
  std::size_t count = 0;
  const auto numbers = [&](const char* name, std::size_t width) {
    GltfNumbers found;
    if (gltf_member(*attributes, name) == nullptr) return found;
    found = document.numbers(gltf_count(*attributes, name, 0));
    if (found.width != width || (count > 0 && found.count != count))
      throw GltfRefusal{std::string("the ") + name + " of instances is of a wrong size"};
    count = found.count;
    return found;
  };
  const GltfNumbers translations = numbers("TRANSLATION", 3);
  const GltfNumbers rotations = numbers("ROTATION", 4);
  const GltfNumbers scales = numbers("SCALE", 3);
  if (count > max_placed_meshes) throw GltfRefusal{"has more than a million instances of meshes"};
  std::vector<Eigen::Affine3d> transforms;
  transforms.reserve(count);
  const auto row_of = [](const GltfNumbers& all, std::size_t at) {
    return all.count > 0 ? all.row(at) : nullptr;
  };
  for (std::size_t at = 0; at < count; ++at)
    transforms.push_back(
        transform_by(row_of(translations, at), row_of(rotations, at), row_of(scales, at)));
  return transforms;
}

} // namespace

bool GltfPlacedMesh::mirrors() const noexcept {
  return !joints && T_world_node.linear().determinant() < 0.0;
}

std::vector<Eigen::Vector3d> GltfPlacedMesh::moved(const GltfDocument& document,
                                                   const Json& attributes,
                                                   const GltfNumbers& places) const {
  const bool skinned = joints && gltf_member(attributes, "JOINTS_0") != nullptr &&
                       gltf_member(attributes, "WEIGHTS_0") != nullptr;
  std::vector<Eigen::Vector3d> moved;
  moved.reserve(places.count);
  if (!skinned) {
    for (std::size_t at = 0; at < places.count; ++at)
      moved.push_back(T_world_node * Eigen::Vector3d(places.row(at)));
    return moved;
  }
  const GltfNumbers of = document.numbers(gltf_count(attributes, "JOINTS_0", 0));
  const GltfNumbers shares = document.numbers(gltf_count(attributes, "WEIGHTS_0", 0));
  if (of.width != 4 || shares.width != 4 || of.count != places.count ||
      shares.count != places.count)
    throw GltfRefusal{"a skinned primitive has not four joints for each vertex"};
  for (std::size_t at = 0; at < places.count; ++at) {
    const Eigen::Vector3d place(places.row(at));
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double whole = 0.0;
    for (std::size_t k = 0; k < 4; ++k) {
      const double weight = shares.row(at)[k];
      if (!(weight > 0.0)) continue;
      const double joint = of.row(at)[k];
      if (!(joint >= 0.0 && joint < static_cast<double>(joints->size())))
        throw GltfRefusal{"a vertex names a joint that is not there"};
      sum += weight * ((*joints)[static_cast<std::size_t>(joint)] * place);
      whole += weight;
    }
    moved.push_back(whole > 0.0 ? Eigen::Vector3d(sum / whole) : place);
  }
  return moved;
}

std::vector<GltfPlacedMesh> placed_meshes(const GltfDocument& document) {
  const NodeTree tree(document);
  std::vector<GltfPlacedMesh> placed;
  std::map<std::uint64_t, std::shared_ptr<const std::vector<Eigen::Affine3d>>> skins;
  for (const std::uint64_t node : tree.order()) {
    const Json& given = document.item("nodes", node);
    if (gltf_member(given, "mesh") == nullptr) continue;
    GltfPlacedMesh mesh;
    mesh.mesh = gltf_count(given, "mesh", 0);
    mesh.name = gltf_text(given, "name");
    mesh.T_world_node = tree.transform(node);
    mesh.weights = default_weights(given, document.item("meshes", mesh.mesh));
    if (gltf_member(given, "skin") != nullptr) {
      auto& joints = skins[gltf_count(given, "skin", 0)];
      if (!joints)
        joints = std::make_shared<const std::vector<Eigen::Affine3d>>(
            joints_of(document, tree, gltf_count(given, "skin", 0)));
      mesh.joints = joints;
    }
    const Json* const instances = gltf_extension(given, "EXT_mesh_gpu_instancing");
    if (instances == nullptr) {
      placed.push_back(std::move(mesh));
      continue;
    }
    for (const Eigen::Affine3d& T_node_instance : instances_of(document, *instances)) {
      placed.push_back(mesh);
      placed.back().T_world_node = mesh.T_world_node * T_node_instance;
      if (placed.size() > max_placed_meshes)
        throw GltfRefusal{"has more than a million instances of meshes"};
    }
  }
  return placed;
}

std::size_t apply_targets(const GltfDocument& document, const Json& primitive,
                          const std::vector<double>& weights, GltfNumbers& places) {
  const Json* const targets = gltf_member(primitive, "targets");
  if (targets == nullptr || !targets->is_array()) return 0;
  std::size_t read = 0;
  for (std::size_t at = 0; at < std::min(weights.size(), targets->size()); ++at) {
    const Json& target = (*targets)[at];
    if (weights[at] == 0.0 || gltf_member(target, "POSITION") == nullptr) continue;
    const GltfNumbers moved = document.numbers(gltf_count(target, "POSITION", 0));
    if (moved.width != 3 || moved.count != places.count)
      throw GltfRefusal{"a morph target is of another size than its vertices"};
    read += moved.count;
    for (std::size_t k = 0; k < places.values.size(); ++k)
      places.values[k] += weights[at] * moved.values[k];
  }
  return read;
}

} // namespace nendo::deform
