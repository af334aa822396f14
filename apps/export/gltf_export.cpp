#include "export/gltf_export.hpp"

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "export/gltf_model.hpp"
#include "export/gltf_sums.hpp"
#include "export/gltf_take.hpp"
#include "export/key_shapes.hpp"

namespace nendo::exporting {
namespace {

using Json = GlbFile::Json;

Error too_many_keys(const std::filesystem::path& path) {
  return {Errc::failed, path.string() + ": needs more key shapes than programs can read; use a "
                                        "greater --tolerance, a lower --rate, or --from and --to"};
}

/// A take without a model.
Result<Exported> hands_alone(takes::FrameSource& source, const Choice& choice,
                             const GltfOptions& options, const std::filesystem::path& path) {
  auto frames = ChosenFrames::make(source, choice);
  if (!frames) return frames.error();
  const auto played =
      play_frames(*frames, options.hands,
                  [](const flow::Frame&, float, const deform::Points&) { return true; });
  if (!played) return played.error();
  if (!played->hands[0] && !played->hands[1])
    return Error{Errc::bad_input, path.string() + ": there would be neither a model nor a hand in "
                                                  "it"};
  GltfTake document(options);
  return finish_take(document, Json::array(), *played, *frames, choice.rate_hz, path);
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
  void animate(GltfTake& document) const {
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
                       const Played& played, double diagonal, GltfTake& document) {
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
  GltfTake document(options);
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
  const auto played = play_frames(*frames, options.hands, see);
  if (!played) return played.error();
  segments.back()->finish();
  if (weight_count(segments) > options.most_weights) return too_many_keys(path);
  std::vector<const deform::Appearance*> looks;
  for (const auto& segment : segments)
    looks.push_back(&source.model(segment->version()).look);
  MorphReport report = add_models(segments, GltfMaterials(richest_of(looks), document.file),
                                  *played, diagonal, document);
  report.tolerance = tolerance / diagonal;
  report.diagonal_m = diagonal / played->units_per_metre;
  Json roots = Json::array();
  for (const auto& segment : segments)
    roots.push_back(segment->model().node());
  auto done = finish_take(document, std::move(roots), *played, *frames, choice.rate_hz, path);
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
