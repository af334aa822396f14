#include "export/gltf_export.hpp"

#include <array>
#include <cmath>
#include <functional>

#include "export/control_morphs.hpp"
#include "export/gltf_model.hpp"
#include "export/hand_rig.hpp"
#include "export/key_shapes.hpp"

namespace nendo::exporting {
namespace {

using Json = GlbFile::Json;

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

Error not_finite(double time_s) {
  return {Errc::bad_input, "at " + std::to_string(time_s) +
                               " s there are numbers that 32-bit floats cannot hold; scale the "
                               "model down, or leave the hands out with --no-hands"};
}

Error too_many_keys(const std::filesystem::path& path) {
  return {Errc::failed, path.string() + ": needs more key shapes than programs can read; use a "
                                        "greater --tolerance, a lower --rate, or --from and --to"};
}

bool follow_hands(const flow::Frame& frame, Played& played) {
  for (const Side side : {Side::left, Side::right}) {
    const std::size_t slot = flow::Placement::index_of(side);
    const flow::HandFrame& hand = frame.hands[slot];
    if (played.times_s.size() == 1 && hand.present) played.hands[slot].emplace(side);
    if (played.hands[slot] && !played.hands[slot]->add(hand.pose)) return false;
  }
  return true;
}

Result<Played> play(ChosenFrames& frames, bool hands, const See& see) {
  Played played;
  deform::Points vertices;
  for (;;) {
    const auto more = frames.next();
    if (!more) return more.error();
    if (!*more) break;
    const auto time_s = static_cast<float>(frames.time_s() - frames.first_s());
    // Ticks that followed each other at once; a player wants times that rise.
    if (!played.times_s.empty() && !(time_s > played.times_s.back())) continue;
    const flow::Frame& frame = frames.frame();
    frames.vertices(vertices);
    played.times_s.push_back(time_s);
    if (!vertices.cast<float>().allFinite() || (hands && !follow_hands(frame, played)))
      return not_finite(frames.time_s());
    if (!see(frame, time_s, vertices)) return played;
    played.units_per_metre = frame.units_per_metre;
    played.last_s = frames.time_s();
  }
  played.to_the_end = true;
  return played;
}

/// One file, with the part of its document that animates.
struct Document {
  explicit Document(const GltfOptions& options)
      : file(options.generator),
        animation{{"name", "take"}, {"samplers", Json::array()}, {"channels", Json::array()}} {}

  void animate(GlbFile::Index node, GlbFile::Index times, GlbFile::Index weights) {
    animation["samplers"].push_back(
        {{"input", times}, {"output", weights}, {"interpolation", "LINEAR"}});
    animation["channels"].push_back({{"sampler", animation["samplers"].size() - 1},
                                     {"target", {{"node", node}, {"path", "weights"}}}});
  }

  GlbFile file;
  Json animation;
};

/// `roots` are those that the document has already. The hands' are added.
Result<Exported> finish(Document& document, Json roots, const Played& played,
                        const ChosenFrames& frames, const std::optional<double>& rate_hz,
                        const std::filesystem::path& path) {
  GlbFile& file = document.file;
  GlbFile::Index times = 0;
  const bool has_hands = played.hands[0] || played.hands[1];
  if (has_hands) times = file.add_scalars(played.times_s, true);
  for (const auto& hand : played.hands)
    if (hand) add_hand(*hand, times, file, document.animation, roots);
  file["scene"] = 0;
  file.add("scenes", {{"name", "stage"}, {"nodes", std::move(roots)}});
  if (!document.animation["channels"].empty())
    file.add("animations", std::move(document.animation));
  const auto bytes = file.write(path);
  if (!bytes) return bytes.error();
  Exported done{{path.string()}, played.times_s.size(), frames.first_s(), played.last_s, *bytes};
  done.rate_hz = rate_hz;
  done.exact = frames.source().is_exact();
  return done;
}

/// Finishes a document that has the model.
Result<Exported> finish(Document& document, const GltfModel& model, const Played& played,
                        MorphReport report, const ChosenFrames& frames,
                        const std::optional<double>& rate_hz, const std::filesystem::path& path) {
  report.diagonal_m = frames.source().layout().diagonal() / played.units_per_metre;
  model.add_to(document.file, played.units_per_metre, report);
  auto done = finish(document, Json::array({GltfModel::node}), played, frames, rate_hz, path);
  if (done) done->morphs = report;
  return done;
}

/// A take without a model.
Result<Exported> hands_alone(takes::FrameSource& source, const Choice& choice,
                             const GltfOptions& options, const std::filesystem::path& path) {
  auto frames = ChosenFrames::make(source, choice);
  if (!frames) return frames.error();
  const auto played = play(*frames, options.hands,
                           [](const flow::Frame&, float, const deform::Points&) { return true; });
  if (!played) return played.error();
  if (!played->hands[0] && !played->hands[1])
    return Error{Errc::bad_input, path.string() + ": there would be neither a model nor a hand in "
                                                  "it"};
  Document document(options);
  return finish(document, Json::array(), *played, *frames, choice.rate_hz, path);
}

/// Nothing, if the take is not linear in control vectors.
Result<std::optional<Exported>> by_control_vectors(takes::FrameSource& source, const Choice& choice,
                                                   const GltfOptions& options,
                                                   const std::filesystem::path& path) {
  auto frames = ChosenFrames::make(source, choice);
  if (!frames) return frames.error();
  ControlMorphs morphs(source.layout());
  const auto played = play(*frames, options.hands,
                           [&](const flow::Frame& frame, float, const deform::Points& vertices) {
                             return morphs.add(frame, vertices);
                           });
  if (!played) return played.error();
  if (!played->to_the_end) return std::optional<Exported>();
  Document document(options);
  GltfModel model(source.model(), document.file);
  const auto weights = model.add_control_targets(morphs, document.file);
  if (!weights.empty()) {
    const auto times = document.file.add_scalars(played->times_s, true);
    document.animate(GltfModel::node, times, document.file.add_scalars(weights, false));
  }
  MorphReport report;
  report.by_control_vectors = true;
  report.targets = model.target_count();
  report.keys = weights.empty() ? 0 : played->times_s.size();
  report.greatest_error = morphs.greatest_error() / source.layout().diagonal();
  auto done = finish(document, model, *played, report, *frames, choice.rate_hz, path);
  if (!done) return done.error();
  return std::optional<Exported>(*std::move(done));
}

Result<Exported> by_key_shapes(takes::FrameSource& source, const Choice& choice,
                               const GltfOptions& options, const std::filesystem::path& path) {
  auto frames = ChosenFrames::make(source, choice);
  if (!frames) return frames.error();
  const double diagonal = source.layout().diagonal();
  const deform::Points& rest = source.layout().original();
  Document document(options);
  GltfModel model(source.model(), document.file);
  std::vector<float> key_times_s;
  // The source is at the first frame, which tells the scale.
  const double tolerance = options.tolerance_m
                               ? *options.tolerance_m * source.frame().units_per_metre
                               : options.tolerance * diagonal;
  KeyShapes keys(tolerance, [&](float time_s, const KeyShapes::Shape& way) {
    key_times_s.push_back(time_s);
    model.add_key_target(way, document.file);
  });
  const auto played = play(*frames, options.hands,
                           [&](const flow::Frame&, float time_s, const deform::Points& vertices) {
                             keys.add(time_s, (vertices - rest).cast<float>());
                             return model.key_weight_count() <= options.most_weights;
                           });
  if (!played) return played.error();
  keys.finish();
  if (model.key_weight_count() > options.most_weights) return too_many_keys(path);
  if (model.target_count() > 0) {
    const auto times = document.file.add_scalars(key_times_s, true);
    document.animate(GltfModel::node, times, model.add_key_weights(document.file));
  }
  // A reader adds targets to a rest shape that is rounded to floats, too.
  const double rounding = (rest.cast<float>().cast<double>() - rest).colwise().norm().maxCoeff();
  MorphReport report;
  report.targets = model.target_count();
  report.keys = key_times_s.size();
  report.tolerance = tolerance / diagonal;
  report.greatest_error = (keys.greatest_error() + rounding) / diagonal;
  return finish(document, model, *played, report, *frames, choice.rate_hz, path);
}

} // namespace

Result<Exported> export_gltf(const OpenFrames& open, const Choice& choice,
                             const GltfOptions& options, const std::filesystem::path& path) {
  auto source = open();
  if (!source) return source.error();
  if ((*source)->model().vertices.cols() == 0) return hands_alone(**source, choice, options, path);
  auto exact = by_control_vectors(**source, choice, options, path);
  if (!exact) return exact.error();
  if (*exact) return *std::move(*exact);
  source = open();
  if (!source) return source.error();
  return by_key_shapes(**source, choice, options, path);
}

} // namespace nendo::exporting
