#pragma once
// What all ways of exporting a take as glTF share: playing its frames, the document with its
// animation, and models that are shown one after another.

#include <array>
#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

#include "export/chosen_frames.hpp"
#include "export/exported.hpp"
#include "export/glb_file.hpp"
#include "export/gltf_export.hpp"
#include "export/gltf_model.hpp"
#include "export/hand_rig.hpp"

namespace nendo::exporting {

/// What is exported, how, and where to.
struct GltfJob {
  ChosenFrames& frames;
  const GltfOptions& options;
  const std::filesystem::path& path;
};

/// What of a take is not its shapes.
struct Played {
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
Result<Played> play_frames(const GltfJob& job, const AddFrame& add);

/// One file, with the part of its document that animates.
struct GltfTake {
  explicit GltfTake(const GltfOptions& options)
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
Result<Exported> finish_models(const GltfJob& job, const Played& played,
                               const std::vector<MovingModel>& models, MorphReport report,
                               GltfTake& document);
/// Adds the hands, and writes the file. `roots` are the nodes of the models.
Result<Exported> finish_take(const GltfJob& job, const Played& played, GlbFile::Json roots,
                             GltfTake& document);

} // namespace nendo::exporting
