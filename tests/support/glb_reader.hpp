#pragma once
// A reader of binary glTF 2.0, written from the specification and not from the writer. It reads
// accessors, morph targets and joints. It throws if it cannot read a file.

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

namespace nendo::test {

class Glb {
public:
  explicit Glb(const std::string& file) {
    const auto word = [&](std::size_t at) {
      std::uint32_t value = 0;
      if (at + 4 > file.size()) throw std::runtime_error("the file ends too early");
      std::memcpy(&value, file.data() + at, 4);
      return value;
    };
    if (file.substr(0, 4) != "glTF" || word(4) != 2 || word(8) != file.size())
      throw std::runtime_error("not a GLB of that length");
    const std::uint32_t json_length = word(12);
    if (file.substr(16, 4) != "JSON" || json_length % 4 != 0)
      throw std::runtime_error("no JSON chunk");
    json = nlohmann::json::parse(file.substr(20, json_length));
    const std::size_t binary = 20 + json_length;
    if (file.substr(binary + 4, 4) != std::string("BIN\0", 4) ||
        binary + 8 + word(binary) != file.size() || word(binary) % 4 != 0)
      throw std::runtime_error("no BIN chunk");
    bytes_ = file.substr(binary + 8);
    if (json.at("buffers").at(0).at("byteLength") > bytes_.size())
      throw std::runtime_error("the buffer is shorter than it says");
  }

  nlohmann::json json;

  /// Returns the rows of an accessor, each as wide as its type, with unscaled numbers.
  Eigen::MatrixXd accessor(std::size_t index) const {
    const auto& accessor = json.at("accessors").at(index);
    const Eigen::Index width = width_of(accessor.at("type"));
    const Eigen::Index count = accessor.at("count");
    Eigen::MatrixXd values = Eigen::MatrixXd::Zero(width, count);
    if (accessor.contains("bufferView")) {
      values = numbers(accessor.at("bufferView"), accessor.at("componentType"), width, count);
    }
    if (accessor.contains("sparse")) {
      const auto& sparse = accessor.at("sparse");
      const Eigen::Index some = sparse.at("count");
      const auto& indices = sparse.at("indices");
      const auto places = numbers(indices.at("bufferView"), indices.at("componentType"), 1, some);
      const auto given =
          numbers(sparse.at("values").at("bufferView"), accessor.at("componentType"), width, some);
      for (Eigen::Index at = 0; at < some; ++at) {
        if (at > 0 && places(0, at) <= places(0, at - 1))
          throw std::runtime_error("sparse indices do not rise");
        if (places(0, at) >= static_cast<double>(count))
          throw std::runtime_error("a sparse index is too large");
        values.col(static_cast<Eigen::Index>(places(0, at))) = given.col(at);
      }
    }
    if (accessor.contains("min")) check_bounds(accessor, values);
    return values;
  }

  /// Returns a node's translation, rotation or weights at a time of the animation.
  Eigen::VectorXd animated(std::size_t node, const std::string& path, double time_s,
                           const Eigen::VectorXd& still) const {
    if (!json.contains("animations")) return still;
    const auto& animation = json.at("animations").at(0);
    for (const auto& channel : animation.at("channels")) {
      const auto& target = channel.at("target");
      if (target.at("node") != node || target.at("path") != path) continue;
      const auto& sampler = animation.at("samplers").at(channel.at("sampler").get<std::size_t>());
      const bool steps = sampler.at("interpolation") == "STEP";
      if (!steps && sampler.at("interpolation") != "LINEAR") throw std::runtime_error("not linear");
      const Eigen::MatrixXd times = accessor(sampler.at("input"));
      Eigen::MatrixXd values = accessor(sampler.at("output"));
      values = Eigen::MatrixXd(values.reshaped(values.size() / times.size(), times.size()));
      if (!steps) return at_time(times, values, time_s);
      Eigen::Index key = 0; // the last that is not later
      while (key + 1 < times.size() && times.reshaped()[key + 1] <= time_s)
        ++key;
      return values.col(key);
    }
    return still;
  }

  /// Returns the morphed vertices of a node's mesh, or another attribute of its first primitive, in
  /// its own units. 3 by #vertices.
  Eigen::Matrix3Xd vertices(std::size_t node, double time_s,
                            const char* attribute = "POSITION") const {
    const auto& primitive = json.at("meshes")
                                .at(json.at("nodes").at(node).at("mesh").get<std::size_t>())
                                .at("primitives")
                                .at(0);
    Eigen::Matrix3Xd places = accessor(primitive.at("attributes").at(attribute));
    if (!primitive.contains("targets")) return places;
    const auto& targets = primitive.at("targets");
    const Eigen::VectorXd weights =
        animated(node, "weights", time_s, Eigen::VectorXd::Zero(static_cast<int>(targets.size())));
    if (weights.size() != static_cast<Eigen::Index>(targets.size()))
      throw std::runtime_error("not a weight a target");
    for (std::size_t at = 0; at < targets.size(); ++at) {
      const double weight = weights[static_cast<Eigen::Index>(at)];
      if (weight != 0.0) places += weight * accessor(targets.at(at).at(attribute));
    }
    return places;
  }

  std::size_t node_named(const std::string& name) const {
    const auto& nodes = json.at("nodes");
    for (std::size_t at = 0; at < nodes.size(); ++at)
      if (nodes[at].value("name", "") == name) return at;
    throw std::runtime_error("no node " + name);
  }

  /// Returns where a node is in the scene.
  Eigen::Affine3d world(std::size_t node, double time_s) const {
    const auto& nodes = json.at("nodes");
    const auto& self = nodes.at(node);
    const auto list = [&](const char* key, Eigen::VectorXd still) {
      if (self.contains(key))
        for (Eigen::Index at = 0; at < still.size(); ++at)
          still[at] = self.at(key).at(static_cast<std::size_t>(at));
      return still;
    };
    const Eigen::Vector3d place =
        animated(node, "translation", time_s, list("translation", Eigen::Vector3d::Zero()));
    const Eigen::Vector4d turn =
        animated(node, "rotation", time_s, list("rotation", Eigen::Vector4d::UnitW()));
    const Eigen::Vector3d scale = list("scale", Eigen::Vector3d::Ones());
    const Eigen::Affine3d local =
        Eigen::Translation3d(place) * Eigen::Quaterniond(turn).normalized() * Eigen::Scaling(scale);
    for (std::size_t parent = 0; parent < nodes.size(); ++parent)
      for (const auto& child : nodes[parent].value("children", nlohmann::json::array()))
        if (child == node) return world(parent, time_s) * local;
    return local;
  }

private:
  static Eigen::Index width_of(const std::string& type) {
    if (type == "SCALAR") return 1;
    if (type == "VEC3") return 3;
    if (type == "VEC4") return 4;
    if (type == "MAT4") return 16;
    throw std::runtime_error("a type that is not known: " + type);
  }

  Eigen::MatrixXd numbers(std::size_t view_index, int component, Eigen::Index width,
                          Eigen::Index count) const {
    const auto& view = json.at("bufferViews").at(view_index);
    const std::size_t size = component == 5121 ? 1 : component == 5123 ? 2 : 4;
    const std::size_t begin = view.value("byteOffset", std::size_t{0});
    const std::size_t length = view.at("byteLength");
    const auto needed = static_cast<std::size_t>(width * count) * size;
    if (begin % size != 0 || length < needed || begin + length > bytes_.size())
      throw std::runtime_error("a view that does not fit");
    Eigen::MatrixXd values(width, count);
    for (std::size_t at = 0; at < static_cast<std::size_t>(width * count); ++at) {
      const char* from = bytes_.data() + begin + at * size;
      std::uint32_t bits = 0;
      std::memcpy(&bits, from, size);
      float number = 0.0F;
      std::memcpy(&number, &bits, 4);
      values(static_cast<Eigen::Index>(at)) =
          component == 5126 ? static_cast<double>(number) : static_cast<double>(bits);
    }
    return values;
  }

  static void check_bounds(const nlohmann::json& accessor, const Eigen::MatrixXd& values) {
    for (Eigen::Index row = 0; row < values.rows(); ++row) {
      const auto at = static_cast<std::size_t>(row);
      if (accessor.at("min").at(at) != values.row(row).minCoeff() ||
          accessor.at("max").at(at) != values.row(row).maxCoeff())
        throw std::runtime_error("min or max is not what it says");
    }
  }

  static Eigen::VectorXd at_time(const Eigen::MatrixXd& times, const Eigen::MatrixXd& values,
                                 double time_s) {
    if (time_s <= times(0)) return values.col(0);
    for (Eigen::Index at = 1; at < times.size(); ++at) {
      if (times(at) <= times(at - 1)) throw std::runtime_error("times do not rise");
      if (time_s > times(at)) continue;
      const double share = (time_s - times(at - 1)) / (times(at) - times(at - 1));
      return (1.0 - share) * values.col(at - 1) + share * values.col(at);
    }
    return values.col(values.cols() - 1);
  }

  std::string bytes_;
};

} // namespace nendo::test
