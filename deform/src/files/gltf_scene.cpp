#include "files/gltf_scene.hpp"

#include <algorithm>
#include <utility>

#include "files/gltf_document.hpp"
#include "geometry/usable.hpp"

namespace nendo::deform {
namespace {

using Json = GltfDocument::Json;

std::vector<double> weights_in(const Json& item) {
  std::vector<double> weights;
  for (const Json& number : gltf_list(item, "weights")) {
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
  const Eigen::Affine3d& transform(std::uint64_t node) const { return T_world_node_[node]; }

private:
  std::vector<std::uint64_t> roots() const {
    if (document_.size_of("scenes") > 0)
      return numbers_in(
          document_, document_.item("scenes", gltf_count(document_.root(), "scene", 0)), "nodes");
    std::vector<bool> is_child(T_world_node_.size(), false);
    for (std::size_t node = 0; node < is_child.size(); ++node)
      for (const std::uint64_t child :
           numbers_in(document_, document_.item("nodes", node), "children"))
        is_child[child] = true;
    std::vector<std::uint64_t> roots;
    for (std::size_t node = 0; node < is_child.size(); ++node)
      if (!is_child[node]) roots.push_back(node);
    return roots;
  }

  // Without recursion, for a hostile tree may be deep.
  void walk(std::vector<std::uint64_t> waiting) {
    std::reverse(waiting.begin(), waiting.end());
    for (const std::uint64_t root : waiting)
      T_world_node_[root] = own_transform(document_.item("nodes", root));
    while (!waiting.empty()) {
      const std::uint64_t node = waiting.back();
      waiting.pop_back();
      if (seen_[node]) throw GltfRefusal{"node " + std::to_string(node) + " is in the scene twice"};
      seen_[node] = true;
      order_.push_back(node);
      auto children = numbers_in(document_, document_.item("nodes", node), "children");
      for (auto child = children.rbegin(); child != children.rend(); ++child) {
        T_world_node_[*child] = transform(node) * own_transform(document_.item("nodes", *child));
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

/// Keeps the textures of a document, each image once.
class GltfTextures {
public:
  GltfTextures(const GltfDocument& document, Appearance& look, NoteSum& notes)
      : document_(document), look_(look), files_(notes) {}

  /// The number, in the look, of the texture that a textureInfo names.
  std::uint32_t number_of(const Json& info) {
    const Json& texture = document_.item("textures", gltf_count(info, "index", 0));
    const auto source = source_of(texture);
    if (!source) return no_index;
    const Json& image = document_.item("images", *source);
    const auto next = to_index(look_.textures.size());
    const auto [place, is_new] = numbers_.emplace(*source, next);
    if (is_new) add(image, *source);
    return place->second;
  }

private:
  /// The number of the image. Where a picture of another format has a PNG or JPEG beside it, that.
  static std::optional<std::uint64_t> source_of(const Json& texture) {
    if (gltf_member(texture, "source") != nullptr) return gltf_count(texture, "source", 0);
    for (const char* const name :
         {"KHR_texture_basisu", "EXT_texture_webp", "EXT_texture_avif", "MSFT_texture_dds"})
      if (const Json* const other = gltf_extension(texture, name);
          other != nullptr && gltf_member(*other, "source") != nullptr)
        return gltf_count(*other, "source", 0);
    return std::nullopt;
  }

  void add(const Json& image, std::uint64_t source) {
    FolderFile file = document_.image(image);
    Texture texture{name_of(image, source, file), nullptr};
    const std::string uri = gltf_text(image, "uri");
    const bool is_within = uri.empty() || is_data_uri(uri);
    files_.take(std::move(file), is_within ? texture.file : percent_decoded(uri), texture);
    look_.textures.push_back(std::move(texture));
  }

  static std::string name_of(const Json& image, std::uint64_t source, const FolderFile& file) {
    if (!file.name.empty()) return file.name;
    const std::string uri = gltf_text(image, "uri");
    if (!uri.empty() && !is_data_uri(uri))
      if (auto name = name_in_folder(percent_decoded(uri))) return *std::move(name);
    const std::string_view contents = file.contents ? std::string_view(*file.contents) : "";
    const std::string ending = contents.starts_with("\xFF\xD8") ? ".jpg" : ".png";
    auto name = name_in_folder(gltf_text(image, "name"));
    if (!name) name = "texture-" + std::to_string(source + 1);
    return name->ends_with(ending) ? *name : *name + ending;
  }

  const GltfDocument& document_;
  Appearance& look_;
  TextureFiles files_; // many images could be one view
  std::map<std::uint64_t, std::uint32_t> numbers_;
};

Eigen::Affine2d transform_of(const Json& info) {
  Eigen::Affine2d transform = Eigen::Affine2d::Identity();
  const Json* const given = gltf_extension(info, "KHR_texture_transform");
  if (given == nullptr) return transform;
  const auto offset = gltf_numbers(*given, "offset", 2);
  const auto scale = gltf_numbers(*given, "scale", 2);
  if (!offset.empty()) transform.translate(Eigen::Vector2d(offset[0], offset[1]));
  const Json* const rotation = gltf_member(*given, "rotation");
  // Its axes are those of glTF's pictures, whose y points down.
  if (rotation != nullptr && rotation->is_number())
    transform.rotate(Eigen::Rotation2Dd(-rotation->get<double>()));
  if (!scale.empty()) transform.scale(Eigen::Vector2d(scale[0], scale[1]));
  return transform;
}

/// Where a material has its base colour: both names are of members of `in`, which may be null.
struct BaseColour {
  const Json* in = nullptr;
  const char* factor = "baseColorFactor";
  const char* texture = "baseColorTexture";
};

BaseColour base_of(const Json& material) {
  const char* const older = "KHR_materials_pbrSpecularGlossiness";
  if (const Json* const diffuse = gltf_extension(material, older);
      diffuse != nullptr && gltf_member(material, "pbrMetallicRoughness") == nullptr)
    return {diffuse, "diffuseFactor", "diffuseTexture"};
  return {gltf_member(material, "pbrMetallicRoughness")};
}

Eigen::Vector4f base_colour(const BaseColour& base) {
  Eigen::Vector4f colour = Eigen::Vector4f::Ones();
  const auto factor =
      base.in == nullptr ? std::vector<double>() : gltf_numbers(*base.in, base.factor, 4);
  for (std::size_t channel = 0; channel < factor.size(); ++channel)
    colour[static_cast<Eigen::Index>(channel)] =
        static_cast<float>(std::clamp(factor[channel], 0.0, 1.0));
  return colour;
}

/// The opacity that a material has in effect.
float opacity_of_material(const Json& material, float alpha) {
  const std::string mode = gltf_text(material, "alphaMode");
  if (mode == "BLEND") return alpha;
  if (mode != "MASK") return 1.0F;
  const Json* const cutoff = gltf_member(material, "alphaCutoff");
  const double least = cutoff != nullptr && cutoff->is_number() ? cutoff->get<double>() : 0.5;
  return static_cast<double>(alpha) >= least ? 1.0F : 0.0F;
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
  const Json::array_t& targets = gltf_list(primitive, "targets");
  std::size_t read = 0;
  for (std::size_t at = 0; at < std::min(weights.size(), targets.size()); ++at) {
    const Json& target = targets[at];
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

std::vector<GltfMaterial> read_gltf_materials(const GltfDocument& document, Appearance& look,
                                              NoteSum& notes) {
  std::vector<GltfMaterial> materials;
  GltfTextures textures(document, look, notes);
  for (std::size_t at = 0; at < document.size_of("materials"); ++at) {
    const Json& given = document.item("materials", at);
    const BaseColour base = base_of(given);
    Material material{gltf_text(given, "name"), base_colour(base), no_index, true};
    (*material.colour)[3] = opacity_of_material(given, (*material.colour)[3]);
    material.drawn = (*material.colour)[3] > 0.0F;
    GltfMaterial& more = materials.emplace_back();
    const Json* const info = base.in == nullptr ? nullptr : gltf_member(*base.in, base.texture);
    if (info != nullptr) {
      material.texture = textures.number_of(*info);
      more.texcoord_set =
          static_cast<std::uint32_t>(std::min<std::uint64_t>(gltf_count(*info, "texCoord", 0), 99));
      more.texture_transform = transform_of(*info);
      if (gltf_text(given, "alphaMode") == "MASK" || gltf_text(given, "alphaMode") == "BLEND")
        notes.add("material", material.name,
                  ": the transparency of its texture is left out, so what it hides is seen");
    }
    look.materials.push_back(std::move(material));
  }
  return materials;
}

} // namespace nendo::deform
