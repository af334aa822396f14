#pragma once
// What all ways of exporting a take as glTF share: playing its frames, the document with its
// animation, and models that are shown one after another.

#include <array>
#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

#include <nendo/hand/skeleton.hpp>

#include "export/chosen_frames.hpp"
#include "export/glb_file.hpp"
#include "export/gltf_export.hpp"
#include "export/gltf_model.hpp"

namespace nendo::exporting {

/// What is exported, how, and where to.
struct GltfJob {
  ChosenFrames& frames;
  const GltfOptions& options;
  const std::filesystem::path& path;
};

/// The poses of a hand, kept as the position and rotation of each joint in the frame of its parent.
class HandTrack {
public:
  explicit HandTrack(Side side) : side_(side) {}

  /// Adds the pose of the next moment, in metres. Returns false, and adds nothing, if it is not
  /// finite.
  bool add(const hand::HandPose& pose);

  Side side() const noexcept { return side_; }
  struct JointTrack {
    std::vector<float> places;    ///< x y z for each moment, metres
    std::vector<float> rotations; ///< quaternions x y z w for each moment, each with the sign
                                  ///< nearest to the previous one
  };
  const JointTrack& operator[](hand::Joint joint) const noexcept {
    return joints_[hand::index_of(joint)];
  }
  /// Returns a pose in the wrist's frame, with the rotations of `turns` and with the bone lengths
  /// of the first pose.
  hand::HandPose first_as(const hand::HandPose& turns) const;

private:
  Side side_;
  std::array<JointTrack, hand::joint_count> joints_;
};

/// The hands and times of a take.
struct PlayedFrames {
  std::vector<float> times_s; ///< since the first frame; they rise
  std::array<std::optional<HandTrack>, 2> hands;
  double units_per_metre = 1.0;
  double last_s = 0.0;
};

/// Receives each frame, its time since the first and its vertices. An error ends the export.
using AddFrame =
    std::function<Result<void>(const flow::Frame& frame, float time_s, const deform::Points&)>;

/// Plays all frames that are wanted. Errors: those of ChosenFrames::next() and of `add`; bad_input
/// (numbers that 32-bit floats cannot hold).
Result<PlayedFrames> play_frames(const GltfJob& job, const AddFrame& add);

/// One file, with the part of its document that animates.
struct GltfAnimation {
  explicit GltfAnimation(const GltfOptions& options)
      : file(options.generator), animation{{"name", "take"},
                                           {"samplers", GlbFile::Json::array()},
                                           {"channels", GlbFile::Json::array()}} {}

  void animate(GlbFile::Index node, const char* path, const char* interpolation,
               GlbFile::Index times, GlbFile::Index values) {
    animation["samplers"].push_back(
        {{"input", times}, {"output", values}, {"interpolation", interpolation}});
    animation["channels"].push_back({{"sampler", animation["samplers"].size() - 1},
                                     {"target", {{"node", node}, {"path", path}}}});
  }

  GlbFile file;
  GlbFile::Json animation;
};

/// A model with its morph targets, which is shown from the first of its times on.
struct MovingModel {
  GltfModel model;
  std::uint32_t version = 0;    ///< Frame::model
  std::vector<float> times_s{}; ///< times of the weights, since the first frame of the take
  std::vector<float> weights{}; ///< all targets, time by time; empty: those of key shapes
  double greatest_error = 0.0;  ///< a vertex' max error, model units
};

/// Adds the models, which follow each other in time, and the hands, and writes the file. `report`
/// has what is not known from the models: the kind of their targets, and the tolerance.
Result<Exported> write_models(const GltfJob& job, const PlayedFrames& played,
                              const std::vector<MovingModel>& models, MorphReport report,
                              GltfAnimation& document);
/// Adds the hands, and writes the file. `roots` are the nodes of the models.
Result<Exported> write_hands(const GltfJob& job, const PlayedFrames& played, GlbFile::Json roots,
                             GltfAnimation& document);

} // namespace nendo::exporting
