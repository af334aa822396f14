#include "export/gltf_animation.hpp"

#include <algorithm>
#include <string>
#include <utility>

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

/// The 26 nodes; gives that of joint 0, the others follow.
GlbFile::Index add_joints(const HandTrack& track, GlbFile::Index times, GltfAnimation& document) {
  GlbFile& file = document.file;
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
    if (moves(joint.places, 3, min_displacement_m))
      document.animate(base + at, "translation", "LINEAR", times,
                       file.add_vectors(columns_of(joint.places), GlbFile::Use::animation, false));
    if (moves(joint.rotations, 4, min_turn))
      document.animate(base + at, "rotation", "LINEAR", times,
                       file.add_numbers(joint.rotations, 4, GlbFile::Use::animation));
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
                            {"inverseBindMatrices", file.add_numbers(inverses, 16, {})}});
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
                  {"WEIGHTS_0", file.add_numbers(weights, 4, Use::vertices)}};
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

/// Adds a tree of 26 nodes, one for each joint of OpenXR, that turn over time, under a node of the
/// hand's own ("left hand"), and a skin that follows them ("left hand skin"). The root nodes go to
/// `roots`. `times` is the accessor of the track's moments, of which there must be at least one.
void add_hand(const HandTrack& track, GlbFile::Index times, GltfAnimation& document, Json& roots) {
  GlbFile& file = document.file;
  const hand::HandPose bind = track.first_as(render::HandSkin::bind_pose(track.side()));
  const GlbFile::Index base = add_joints(track, times, document);
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

Error not_finite(double time_s) {
  return {Errc::bad_input, "at " + std::to_string(time_s) +
                               " s there are numbers that 32-bit floats cannot hold; scale the "
                               "model down, or leave the hands out with --no-hands"};
}

/// Moves the nodes of the scene there. A node's place is a decimal number, so the floats of
/// vertices need not hold it. A skin is where its joints are.
void put_at(const Eigen::Vector3d& place_m, const GlbFile::Json& roots, GlbFile& file) {
  if (place_m.isZero(0.0)) return;
  for (const auto& root : roots) {
    auto& node = file["nodes"][root.get<GlbFile::Index>()];
    if (!node.contains("skin")) node["translation"] = {place_m.x(), place_m.y(), place_m.z()};
  }
}

bool follow_hands(const flow::Frame& frame, PlayedFrames& played) {
  for (const Side side : {Side::left, Side::right}) {
    const std::size_t slot = flow::Placement::index_of(side);
    const flow::HandFrame& hand = frame.hands[slot];
    if (played.times_s.size() == 1 && hand.present) played.hands[slot].emplace(side);
    if (played.hands[slot] && !played.hands[slot]->add(hand.pose)) return false;
  }
  return true;
}

/// Shows each model in its time only. A node whose scale is 0 is hidden (glTF 2.0, 3.5.3).
void show_one_by_one(const std::vector<MovingModel>& models, double units_per_metre,
                     GltfAnimation& document) {
  if (models.size() < 2) return;
  const auto scale = static_cast<float>(1.0 / units_per_metre);
  for (std::size_t at = 0; at < models.size(); ++at) {
    std::vector<float> times_s{0.0F};
    std::vector<float> scales{at == 0 ? scale : 0.0F};
    const auto change = [&](float time_s, float to) {
      times_s.push_back(time_s);
      scales.push_back(to);
    };
    if (at > 0) change(models[at].times_s.front(), scale);
    if (at + 1 < models.size()) change(models[at + 1].times_s.front(), 0.0F);
    Eigen::Matrix3Xf vectors(3, static_cast<Eigen::Index>(scales.size()));
    for (std::size_t key = 0; key < scales.size(); ++key)
      vectors.col(static_cast<Eigen::Index>(key)).setConstant(scales[key]);
    document.animate(models[at].model.node(), "scale", "STEP",
                     document.file.add_scalars(times_s, true),
                     document.file.add_vectors(vectors, GlbFile::Use::animation, false));
  }
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

Result<PlayedFrames> play_frames(const GltfJob& job, const AddFrame& add) {
  ChosenFrames& frames = job.frames;
  PlayedFrames played;
  deform::Points vertices;
  const auto done = frames.for_each([&]() -> Result<void> {
    const auto time_s = static_cast<float>(frames.time_s() - frames.first_s());
    // Ticks that followed each other at once; a player wants times that rise.
    if (!played.times_s.empty() && !(time_s > played.times_s.back())) return {};
    const flow::Frame& frame = frames.frame();
    frames.vertices(vertices);
    played.times_s.push_back(time_s);
    if (!vertices.cast<float>().allFinite() || (job.options.hands && !follow_hands(frame, played)))
      return not_finite(frames.time_s());
    played.units_per_metre = frame.units_per_metre;
    played.last_s = frames.time_s();
    return add(frame, time_s, vertices);
  });
  if (!done) return done.error();
  return played;
}

Result<Exported> write_models(const GltfJob& job, const PlayedFrames& played,
                              const std::vector<MovingModel>& models, MorphReport report,
                              GltfAnimation& document) {
  const takes::FrameSource& source = job.frames.source();
  const double diagonal = source.layout(models.front().version).diagonal();
  std::vector<const deform::Appearance*> looks;
  looks.reserve(models.size());
  for (const MovingModel& one : models)
    looks.push_back(&source.model(one.version).look);
  const GltfMaterials materials(richest_of(looks), document.file);
  report.models = models.size();
  report.diagonal_m = diagonal / played.units_per_metre;
  GlbFile::Json roots = GlbFile::Json::array();
  for (const MovingModel& one : models) {
    if (one.model.target_count() > 0) {
      const auto times = document.file.add_scalars(one.times_s, true);
      document.animate(one.model.node(), "weights", "LINEAR", times,
                       one.weights.empty() ? one.model.add_key_weights(document.file)
                                           : document.file.add_scalars(one.weights, false));
      report.keys += one.times_s.size();
    }
    MorphReport own = report;
    own.greatest_error = one.greatest_error / diagonal;
    one.model.add_to(document.file, materials, played.units_per_metre, own);
    report.targets += one.model.target_count();
    report.greatest_error = std::max(report.greatest_error, own.greatest_error);
    roots.push_back(one.model.node());
  }
  show_one_by_one(models, played.units_per_metre, document);
  auto done = write_hands(job, played, std::move(roots), document);
  if (done) done->morphs = report;
  return done;
}

Result<Exported> write_hands(const GltfJob& job, const PlayedFrames& played, GlbFile::Json roots,
                             GltfAnimation& document) {
  GlbFile& file = document.file;
  GlbFile::Index times = 0;
  const bool has_hands = played.hands[0] || played.hands[1];
  if (has_hands) times = file.add_scalars(played.times_s, true);
  for (const auto& hand : played.hands)
    if (hand) add_hand(*hand, times, document, roots);
  const takes::FrameSource& source = job.frames.source();
  put_at(source.model(0).offset / played.units_per_metre, roots, file);
  file["scene"] = 0;
  file.add("scenes", {{"name", "stage"}, {"nodes", std::move(roots)}});
  if (!document.animation["channels"].empty())
    file.add("animations", std::move(document.animation));
  const auto bytes = file.write(job.path);
  if (!bytes) return bytes.error();
  Exported done{
      {job.path.string()}, played.times_s.size(), job.frames.first_s(), played.last_s, *bytes};
  done.rate_hz = job.frames.rate_hz();
  done.exact = source.is_exact();
  return done;
}

} // namespace nendo::exporting
