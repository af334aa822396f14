#include "export/gltf_sums.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include <nendo/deform/triangles.hpp>

#include "export/control_morphs.hpp"
#include "export/function_morphs.hpp"
#include "export/gltf_model.hpp"
#include "export/gltf_take.hpp"

namespace nendo::exporting {
namespace {

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
                             MorphBasis basis, const Played& played, GltfTake& document) {
  const double diagonal = take.source.layout(models.front().version).diagonal();
  std::vector<const deform::Appearance*> looks;
  for (const SummedModel& one : models)
    looks.push_back(&take.source.model(one.version).look);
  const GltfMaterials materials(richest_of(looks), document.file);
  MorphReport report;
  report.basis = basis;
  report.models = models.size();
  report.diagonal_m = diagonal / played.units_per_metre;
  std::vector<Shown> shown;
  GlbFile::Json roots = GlbFile::Json::array();
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
      finish_take(document, std::move(roots), played, take.frames, take.choice.rate_hz, take.path);
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
    const deform::Mesh mesh =
        deform::in_shape(take_.source.model(frame.model), morphs_->rest().cast<double>());
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

} // namespace

Result<std::optional<Exported>> by_functions(const SumTake& take) {
  GltfTake document(take.options);
  FunctionModels models(take, document.file);
  const auto played =
      play_frames(take.frames, take.options.hands,
                  [&](const flow::Frame& frame, float time_s, const deform::Points& vertices) {
                    return models.add(frame, time_s, vertices);
                  });
  if (!played) return played.error();
  if (!played->to_the_end) return std::optional<Exported>();
  auto done = finish_sums(take, models.finish(), MorphBasis::functions, *played, document);
  if (!done) return done.error();
  return std::optional<Exported>(*std::move(done));
}

Result<std::optional<Exported>> by_control_vectors(const SumTake& take) {
  const std::uint32_t version = take.source.frame().model;
  const deform::BlockLayout& layout = take.source.layout(version);
  Eigen::VectorXd weights;
  if (const puppet::Rig* const masks = take.source.masks())
    weights = puppet::mask_weights(masks->puppet(), layout.original());
  ControlMorphs morphs(layout, std::move(weights));
  const auto played =
      play_frames(take.frames, take.options.hands,
                  [&](const flow::Frame& frame, float, const deform::Points& vertices) {
                    return morphs.add(frame, vertices);
                  });
  if (!played) return played.error();
  if (!played->to_the_end) return std::optional<Exported>();
  GltfTake document(take.options);
  std::vector<SummedModel> models;
  models.push_back(
      {GltfModel(take.source.model(version), document.file), version, played->times_s});
  models.back().weights = models.back().model.add_control_targets(morphs, document.file);
  models.back().greatest_error = morphs.greatest_error();
  auto done = finish_sums(take, models, MorphBasis::control_vectors, *played, document);
  if (!done) return done.error();
  return std::optional<Exported>(*std::move(done));
}

} // namespace nendo::exporting
