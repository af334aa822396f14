#pragma once
// What all ways of exporting a take as glTF share: playing its frames, the document with its
// animation, and models that are shown one after another.

#include <array>
#include <functional>
#include <optional>
#include <vector>

#include "export/chosen_frames.hpp"
#include "export/exported.hpp"
#include "export/glb_file.hpp"
#include "export/gltf_export.hpp"
#include "export/hand_rig.hpp"

namespace nendo::exporting {

/// What of a take is not its shapes.
struct Played {
  bool to_the_end = false;
  std::vector<float> times_s; ///< since the first frame; they rise
  std::array<std::optional<HandTrack>, 2> hands;
  double units_per_metre = 1.0;
  double last_s = 0.0;
};

/// Is given each frame, its time since the first and its vertices; false: the rest is not wanted.
using See = std::function<bool(const flow::Frame& frame, float time_s, const deform::Points&)>;

/// Plays all frames that are wanted. Errors: those of ChosenFrames::next(); bad_input (numbers that
/// 32-bit floats cannot hold).
Result<Played> play_frames(ChosenFrames& frames, bool hands, const See& see);

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

/// Writes the file, with the hands. `roots` are the nodes that the document has already; the hands'
/// are added.
Result<Exported> finish_take(GltfTake& document, GlbFile::Json roots, const Played& played,
                             const ChosenFrames& frames, const std::optional<double>& rate_hz,
                             const std::filesystem::path& path);

/// A model, and when it begins to be shown, since the first frame.
struct Shown {
  GlbFile::Index node;
  float begin_s;
};

/// Shows each model in its time only. A node whose scale is 0 is hidden (glTF 2.0, 3.5.3).
void show_one_by_one(const std::vector<Shown>& models, double units_per_metre, GltfTake& document);

} // namespace nendo::exporting
