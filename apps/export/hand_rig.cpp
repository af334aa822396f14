#include "export/hand_rig.hpp"

#include <algorithm>
#include <string>

#include "render/hand_skin.hpp"

namespace nendo::exporting {

using hand::Joint;
using Json = GlbFile::Json;

namespace {

// Below what a float holds of a hand's place on the stage.
constexpr float min_displacement_m = 1e-6F;
constexpr float min_turn = 1e-6F;

constexpr Joint joint_at(std::size_t at) {
  return static_cast<Joint>(at);
}

bool moves(const std::vector<float>& values, std::size_t width, float least) {
  for (std::size_t at = width; at < values.size(); ++at)
    if (std::abs(values[at] - values[at % width]) > least) return true;
  return false;
}

Json first_of(const std::vector<float>& values, std::size_t width) {
  Json list = Json::array();
  for (std::size_t at = 0; at < width; ++at)
    list.push_back(values[at]);
  return list;
}

Eigen::Matrix3Xf columns_of(const std::vector<float>& values) {
  return Eigen::Map<const Eigen::Matrix3Xf>(values.data(), 3,
                                            static_cast<Eigen::Index>(values.size() / 3));
}

void add_channel(GlbFile::Index times, GlbFile::Index values, GlbFile::Index node, const char* path,
                 Json& animation) {
  animation["samplers"].push_back(
      {{"input", times}, {"output", values}, {"interpolation", "LINEAR"}});
  animation["channels"].push_back({{"sampler", animation["samplers"].size() - 1},
                                   {"target", {{"node", node}, {"path", path}}}});
}

/// The 26 nodes; gives that of joint 0, the others follow.
GlbFile::Index add_joints(const HandTrack& track, GlbFile::Index times, GlbFile& file,
                          Json& animation) {
  const GlbFile::Index base = file["nodes"].size();
  const std::string suffix = track.side() == Side::left ? "_L" : "_R";
  for (std::size_t at = 0; at < hand::joint_count; ++at) {
    const HandTrack::JointTrack& joint = track[joint_at(at)];
    Json node{{"name", std::string(name_of(joint_at(at))) + suffix},
              {"translation", first_of(joint.places, 3)},
              {"rotation", first_of(joint.rotations, 4)}};
    for (std::size_t child = 0; child < hand::joint_count; ++child)
      if (parent_of(joint_at(child)) == joint_at(at)) node["children"].push_back(base + child);
    file.add("nodes", std::move(node));
    if (moves(joint.places, 3, min_displacement_m)) {
      const auto places =
          file.add_vectors(columns_of(joint.places), GlbFile::Use::animation, false);
      add_channel(times, places, base + at, "translation", animation);
    }
    if (moves(joint.rotations, 4, min_turn))
      add_channel(times, file.add_quaternions(joint.rotations), base + at, "rotation", animation);
  }
  return base;
}

GlbFile::Index add_skin(const HandTrack& track, const hand::HandPose& bind, GlbFile::Index base,
                        GlbFile& file) {
  Json joints = Json::array();
  std::vector<float> inverses;
  for (std::size_t at = 0; at < hand::joint_count; ++at) {
    joints.push_back(base + at);
    const Eigen::Matrix4f inverse = bind[joint_at(at)].inverse().matrix().cast<float>();
    inverses.insert(inverses.end(), inverse.data(), inverse.data() + inverse.size());
  }
  return file.add("skins", {{"name", std::string(name_of(track.side())) + " hand"},
                            {"joints", std::move(joints)},
                            {"skeleton", base + hand::index_of(Joint::wrist)},
                            {"inverseBindMatrices", file.add_matrices(inverses)}});
}

GlbFile::Index add_mesh(const HandTrack& track, const hand::HandPose& bind, GlbFile& file) {
  const render::HandSkin skin(track.side());
  render::Surface surface;
  skin.drape(bind, Eigen::Vector3d::Zero(), surface);
  Eigen::Matrix3Xf places(3, static_cast<Eigen::Index>(surface.places.size()));
  Eigen::Matrix3Xf normals(3, places.cols());
  std::vector<std::uint8_t> joints;
  std::vector<float> weights;
  for (std::size_t at = 0; at < surface.places.size(); ++at) {
    const auto column = static_cast<Eigen::Index>(at);
    places.col(column) = surface.places[at];
    const Eigen::Vector3f& normal = surface.normals[at];
    normals.col(column) =
        normal.squaredNorm() > 0.0F ? normal.normalized() : Eigen::Vector3f(0.0F, 1.0F, 0.0F);
    for (const auto& [joint, weight] : skin.influences(at)) {
      joints.push_back(weight > 0.0F ? static_cast<std::uint8_t>(hand::index_of(joint)) : 0);
      weights.push_back(weight);
    }
  }
  using Use = GlbFile::Use;
  Json attributes{{"POSITION", file.add_vectors(places, Use::vertices, true)},
                  {"NORMAL", file.add_vectors(normals, Use::vertices, false)},
                  {"JOINTS_0", file.add_joints(joints)},
                  {"WEIGHTS_0", file.add_weights(weights)}};
  const auto material = file.add("materials", {{"name", "hand"},
                                               {"pbrMetallicRoughness",
                                                {{"baseColorFactor", {0.33, 0.345, 0.37, 1.0}},
                                                 {"metallicFactor", 0.0},
                                                 {"roughnessFactor", 0.7}}}});
  return file.add("meshes", {{"name", std::string(name_of(track.side())) + " hand"},
                             {"primitives",
                              {{{"attributes", std::move(attributes)},
                                {"indices", file.add_indices(surface.corners, Use::indices)},
                                {"material", material}}}}});
}

} // namespace

bool HandTrack::add(const hand::HandPose& pose) {
  for (const auto& joint : pose.joints)
    if (!joint.matrix().cast<float>().allFinite()) return false;
  for (std::size_t at = 0; at < hand::joint_count; ++at) {
    const auto parent = parent_of(joint_at(at));
    const Eigen::Isometry3d local =
        parent ? pose[*parent].inverse() * pose[joint_at(at)] : pose[joint_at(at)];
    JointTrack& track = joints_[at];
    const Eigen::Vector3f place = local.translation().cast<float>();
    track.places.insert(track.places.end(), place.begin(), place.end());
    Eigen::Vector4f turn = Eigen::Quaterniond(local.linear()).normalized().coeffs().cast<float>();
    if (!track.rotations.empty()) {
      const Eigen::Map<const Eigen::Vector4f> before(&*(track.rotations.end() - 4));
      if (turn.dot(before) < 0.0F) turn = -turn;
    }
    track.rotations.insert(track.rotations.end(), turn.begin(), turn.end());
  }
  return true;
}

hand::HandPose HandTrack::first_as(const hand::HandPose& turns) const {
  hand::HandPose pose = turns; // the wrist is its origin
  // A joint's number may be less than its parent's: the palm's, which carries none.
  for (std::size_t turn = 0; turn < hand::joint_count; ++turn) {
    const Joint joint = joint_at((turn + 1) % hand::joint_count);
    const auto parent = parent_of(joint);
    if (!parent) continue;
    const auto& places = (*this)[joint].places;
    pose.joints[hand::index_of(joint)].translation() =
        pose[*parent] * Eigen::Vector3d(static_cast<double>(places[0]),
                                        static_cast<double>(places[1]),
                                        static_cast<double>(places[2]));
  }
  return pose;
}

void add_hand(const HandTrack& track, GlbFile::Index times, GlbFile& file, Json& animation,
              Json& roots) {
  const hand::HandPose bind = track.first_as(render::HandSkin::bind_pose(track.side()));
  const GlbFile::Index base = add_joints(track, times, file, animation);
  const GlbFile::Index skin = add_skin(track, bind, base, file);
  const GlbFile::Index mesh = add_mesh(track, bind, file);
  const std::string name = std::string(name_of(track.side())) + " hand";
  // Blender makes the joints' nearest common ancestor that is no joint an armature. Without one of
  // the hand's own that is the whole scene, with the model and both hands in one armature.
  roots.push_back(
      file.add("nodes", {{"name", name}, {"children", {base + hand::index_of(Joint::wrist)}}}));
  // A skinned mesh stays a root, because a parent's transform must not move it.
  roots.push_back(file.add("nodes", {{"name", name + " skin"}, {"mesh", mesh}, {"skin", skin}}));
}

} // namespace nendo::exporting
