#include "export/gltf_export.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>

#include "export/control_morphs.hpp"
#include "export/function_morphs.hpp"
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

  void animate(GlbFile::Index node, const char* path, const char* interpolation,
               GlbFile::Index times, GlbFile::Index values) {
    animation["samplers"].push_back(
        {{"input", times}, {"output", values}, {"interpolation", interpolation}});
    animation["channels"].push_back({{"sampler", animation["samplers"].size() - 1},
                                     {"target", {{"node", node}, {"path", path}}}});
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

/// A model, and when it begins to be shown, since the first frame.
struct Shown {
  GlbFile::Index node;
  float begin_s;
};

/// Shows each model in its time only. A node whose scale is 0 is hidden (glTF 2.0, 3.5.3).
void show_one_by_one(const std::vector<Shown>& models, double units_per_metre, Document& document) {
  if (models.size() < 2) return;
  const auto scale = static_cast<float>(1.0 / units_per_metre);
  for (std::size_t at = 0; at < models.size(); ++at) {
    std::vector<float> times_s{0.0F};
    std::vector<float> scales{at == 0 ? scale : 0.0F};
    const auto change = [&](float time_s, float to) {
      times_s.push_back(time_s);
      scales.push_back(to);
    };
    if (at > 0) change(models[at].begin_s, scale);
    if (at + 1 < models.size()) change(models[at + 1].begin_s, 0.0F);
    Eigen::Matrix3Xf vectors(3, static_cast<Eigen::Index>(scales.size()));
    for (std::size_t key = 0; key < scales.size(); ++key)
      vectors.col(static_cast<Eigen::Index>(key)).setConstant(scales[key]);
    document.animate(models[at].node, "scale", "STEP", document.file.add_scalars(times_s, true),
                     document.file.add_vectors(vectors, GlbFile::Use::animation, false));
  }
}

/// What an exact export needs to know of its frames.
struct SumTake {
  takes::FrameSource& source;
  ChosenFrames& frames;
  const Choice& choice;
  const GltfOptions& options;
  const std::filesystem::path& path;
};

/// A model whose shapes are weighted sums of its targets, and the weights of the frames in which it
/// is shown.
struct SummedModel {
  GltfModel model;
  std::uint32_t version = 0;
  std::vector<float> times_s{};
  std::vector<float> weights{};
  double greatest_error = 0.0; ///< model units
};

/// Adds the models, which follow each other in time, to their document.
Result<Exported> finish_sums(const SumTake& take, const std::vector<SummedModel>& models,
                             MorphBasis basis, const Played& played, Document& document) {
  const double diagonal = take.source.layout(models.front().version).diagonal();
  const GltfMaterials materials(take.source.model(models.front().version).look, document.file);
  MorphReport report;
  report.basis = basis;
  report.models = models.size();
  report.diagonal_m = diagonal / played.units_per_metre;
  std::vector<Shown> shown;
  Json roots = Json::array();
  for (const SummedModel& one : models) {
    if (!one.weights.empty()) {
      const auto times = document.file.add_scalars(one.times_s, true);
      document.animate(one.model.node(), "weights", "LINEAR", times,
                       document.file.add_scalars(one.weights, false));
      report.keys += one.times_s.size();
    }
    MorphReport own = report;
    own.greatest_error = one.greatest_error / diagonal;
    one.model.add_to(document.file, materials, played.units_per_metre, own);
    report.targets += one.model.target_count();
    report.greatest_error = std::max(report.greatest_error, own.greatest_error);
    shown.push_back({one.model.node(), one.times_s.front()});
    roots.push_back(one.model.node());
  }
  show_one_by_one(shown, played.units_per_metre, document);
  auto done =
      finish(document, std::move(roots), played, take.frames, take.choice.rate_hz, take.path);
  if (done) done->morphs = report;
  return done;
}

/// Makes a model of each puppet on each version of its model.
class FunctionModels {
public:
  FunctionModels(const SumTake& take, GlbFile& file) : take_(take), file_(file) {}

  /// Returns false if a shape is no sum of the functions.
  bool add(const flow::Frame& frame, float time_s, const deform::Points& vertices) {
    if (models_.empty() || frame.puppet != puppet_ || frame.model != models_.back().version) {
      end();
      if (!begin(frame, vertices)) return false;
    }
    models_.back().times_s.push_back(time_s);
    return morphs_->add(frame, vertices);
  }
  std::vector<SummedModel>& finish() {
    end();
    return models_;
  }

private:
  bool begin(const flow::Frame& frame, const deform::Points& vertices) {
    const auto puppet = take_.frames.puppet();
    if (!puppet) return false;
    morphs_ = FunctionMorphs::make(*puppet, take_.source.layout(frame.model), frame, vertices);
    if (!morphs_) return false;
    puppet_ = frame.puppet;
    deform::Mesh mesh = take_.source.model(frame.model);
    mesh.vertices = morphs_->rest().cast<double>();
    models_.push_back({GltfModel(mesh, file_), frame.model});
    models_.back().model.add_function_targets(*morphs_, file_);
    return true;
  }
  void end() {
    if (!morphs_) return;
    models_.back().weights = morphs_->weights();
    models_.back().greatest_error = morphs_->greatest_error();
    morphs_.reset();
  }

  const SumTake& take_;
  GlbFile& file_;
  std::vector<SummedModel> models_;
  std::uint32_t puppet_ = 0;
  std::optional<FunctionMorphs> morphs_; ///< of the last model
};

/// Nothing, if the take is not linear in the functions of its puppets.
Result<std::optional<Exported>> by_functions(const SumTake& take) {
  Document document(take.options);
  FunctionModels models(take, document.file);
  const auto played =
      play(take.frames, take.options.hands,
           [&](const flow::Frame& frame, float time_s, const deform::Points& vertices) {
             return models.add(frame, time_s, vertices);
           });
  if (!played) return played.error();
  if (!played->to_the_end) return std::optional<Exported>();
  auto done = finish_sums(take, models.finish(), MorphBasis::functions, *played, document);
  if (!done) return done.error();
  return std::optional<Exported>(*std::move(done));
}

/// The same by the control vectors of a take whose model stays one.
Result<std::optional<Exported>> by_control_vectors(const SumTake& take) {
  const std::uint32_t version = take.source.frame().model;
  const deform::BlockLayout& layout = take.source.layout(version);
  Eigen::VectorXd weights;
  if (const puppet::Rig* const masks = take.source.masks())
    weights = puppet::mask_weights(masks->puppet(), layout.original());
  ControlMorphs morphs(layout, std::move(weights));
  const auto played = play(take.frames, take.options.hands,
                           [&](const flow::Frame& frame, float, const deform::Points& vertices) {
                             return morphs.add(frame, vertices);
                           });
  if (!played) return played.error();
  if (!played->to_the_end) return std::optional<Exported>();
  Document document(take.options);
  std::vector<SummedModel> models;
  models.push_back(
      {GltfModel(take.source.model(version), document.file), version, played->times_s});
  models.back().weights = models.back().model.add_control_targets(morphs, document.file);
  models.back().greatest_error = morphs.greatest_error();
  auto done = finish_sums(take, models, MorphBasis::control_vectors, *played, document);
  if (!done) return done.error();
  return std::optional<Exported>(*std::move(done));
}

/// Consecutive frames of one version of the model, which have a mesh of their own.
class Segment {
public:
  Segment(const takes::FrameSource& source, std::uint32_t version, float begin_s, double tolerance,
          GlbFile& file)
      : version_(version), begin_s_(begin_s), rest_(source.layout(version).original()), file_(file),
        model_(source.model(version), file),
        keys_(tolerance, [this](float time_s, const KeyShapes::Shape& way) {
          key_times_s_.push_back(time_s);
          model_.add_key_target(way, file_);
        }) {}
  Segment(const Segment&) = delete; // keys_ refers to it
  Segment& operator=(const Segment&) = delete;

  std::uint32_t version() const noexcept { return version_; }
  float begin_s() const noexcept { return begin_s_; }
  const GltfModel& model() const noexcept { return model_; }
  std::size_t key_count() const noexcept { return key_times_s_.size(); }

  void add(float time_s, const deform::Points& vertices) {
    keys_.add(time_s, (vertices - rest_).cast<float>());
  }
  void finish() { keys_.finish(); }
  /// Returns the greatest error, in model units. A reader adds targets to a rest shape that is
  /// rounded to floats, too.
  double greatest_error() const {
    return keys_.greatest_error() +
           (rest_.cast<float>().cast<double>() - rest_).colwise().norm().maxCoeff();
  }
  void animate(Document& document) const {
    if (model_.target_count() == 0) return;
    const auto times = document.file.add_scalars(key_times_s_, true);
    document.animate(model_.node(), "weights", "LINEAR", times,
                     model_.add_key_weights(document.file));
  }

private:
  std::uint32_t version_;
  float begin_s_;
  deform::Points rest_;
  GlbFile& file_;
  GltfModel model_;
  std::vector<float> key_times_s_;
  KeyShapes keys_;
};

using Segments = std::vector<std::unique_ptr<Segment>>;

std::uint64_t weight_count(const Segments& segments) {
  std::uint64_t count = 0;
  for (const auto& segment : segments)
    count += segment->model().key_weight_count();
  return count;
}

/// Adds the models of all segments, and tells what became of them.
MorphReport add_models(const Segments& segments, const GltfMaterials& materials,
                       const Played& played, double diagonal, Document& document) {
  MorphReport report;
  for (const auto& segment : segments) {
    segment->animate(document);
    MorphReport own;
    own.greatest_error = segment->greatest_error() / diagonal;
    segment->model().add_to(document.file, materials, played.units_per_metre, own);
    report.targets += segment->model().target_count();
    report.keys += segment->key_count();
    report.greatest_error = std::max(report.greatest_error, own.greatest_error);
  }
  report.models = segments.size();
  std::vector<Shown> shown;
  for (const auto& segment : segments)
    shown.push_back({segment->model().node(), segment->begin_s()});
  show_one_by_one(shown, played.units_per_metre, document);
  return report;
}

Result<Exported> by_key_shapes(takes::FrameSource& source, const Choice& choice,
                               const GltfOptions& options, const std::filesystem::path& path) {
  auto frames = ChosenFrames::make(source, choice);
  if (!frames) return frames.error();
  // The source is at the first frame, which tells the scale.
  const double diagonal = source.layout(source.frame().model).diagonal();
  const double tolerance = options.tolerance_m
                               ? *options.tolerance_m * source.frame().units_per_metre
                               : options.tolerance * diagonal;
  Document document(options);
  Segments segments;
  const auto see = [&](const flow::Frame& frame, float time_s, const deform::Points& vertices) {
    if (segments.empty() || segments.back()->version() != frame.model) {
      if (!segments.empty()) segments.back()->finish();
      segments.push_back(
          std::make_unique<Segment>(source, frame.model, time_s, tolerance, document.file));
    }
    segments.back()->add(time_s, vertices);
    return weight_count(segments) <= options.most_weights;
  };
  const auto played = play(*frames, options.hands, see);
  if (!played) return played.error();
  segments.back()->finish();
  if (weight_count(segments) > options.most_weights) return too_many_keys(path);
  MorphReport report = add_models(
      segments, GltfMaterials(source.model(segments.front()->version()).look, document.file),
      *played, diagonal, document);
  report.tolerance = tolerance / diagonal;
  report.diagonal_m = diagonal / played->units_per_metre;
  Json roots = Json::array();
  for (const auto& segment : segments)
    roots.push_back(segment->model().node());
  auto done = finish(document, std::move(roots), *played, *frames, choice.rate_hz, path);
  if (done) done->morphs = report;
  return done;
}

/// Opens the frames, and exports them in the first way that gives all their shapes.
Result<Exported> export_model(const OpenFrames& open, const Choice& choice,
                              const GltfOptions& options, const std::filesystem::path& path,
                              std::unique_ptr<takes::FrameSource> source) {
  std::vector<decltype(&by_functions)> ways;
  if (source->puppet()) ways.push_back(by_functions);
  if (source->has_one_model()) ways.push_back(by_control_vectors);
  for (const auto way : ways) {
    auto frames = ChosenFrames::make(*source, choice);
    if (!frames) return frames.error();
    auto exact = way({*source, *frames, choice, options, path});
    if (!exact) return exact.error();
    if (*exact) return *std::move(*exact);
    auto again = open();
    if (!again) return again.error();
    source = *std::move(again);
  }
  return by_key_shapes(*source, choice, options, path);
}

} // namespace

std::string_view name_of(MorphBasis basis) noexcept {
  switch (basis) {
  case MorphBasis::functions:
    return "functions";
  case MorphBasis::control_vectors:
    return "control vectors";
  case MorphBasis::key_shapes:
    break;
  }
  return "key shapes";
}

Result<Exported> export_gltf(const OpenFrames& open, const Choice& choice,
                             const GltfOptions& options, const std::filesystem::path& path) {
  auto source = open();
  if (!source) return source.error();
  if ((*source)->model(0).vertices.cols() == 0) return hands_alone(**source, choice, options, path);
  const bool has_puppet = (*source)->puppet().has_value();
  auto done = export_model(open, choice, options, path, *std::move(source));
  if (done && done->morphs) done->morphs->has_puppet = has_puppet;
  return done;
}

} // namespace nendo::exporting
