#include "export/gltf_export.hpp"

#include <memory>
#include <utility>
#include <vector>

#include "export/gltf_keys.hpp"
#include "export/gltf_sums.hpp"
#include "export/gltf_take.hpp"

namespace nendo::exporting {
namespace {

/// The morph targets of a take. They are of the first kind that gives the shapes of all frames, of
/// those that are tried side by side. Where the last exact kind ends, key shapes begin with the
/// frames before, as the sums that these were. So each frame is needed once.
class TakeMorphs {
public:
  /// The source must be at the first frame, which has the scale.
  TakeMorphs(const GltfJob& job, bool has_puppet)
      : job_(job), has_puppet_(has_puppet), document_(job.options) {
    const takes::FrameSource& source = job.frames.source();
    const flow::Frame& first = source.frame();
    diagonal_ = source.layout(first.model).diagonal();
    tolerance_ = job.options.tolerance_m ? *job.options.tolerance_m * first.units_per_metre
                                         : job.options.tolerance * diagonal_;
    if (has_puppet) exact_.push_back(morphs_by_functions(job.frames));
    if (source.has_one_model()) exact_.push_back(morphs_by_control_vectors(source));
    if (exact_.empty()) keys_.emplace(job, tolerance_, 0.0, document_.file);
  }

  /// Adds the next frame. Errors: those of KeyShapeModels::add().
  Result<void> add(const flow::Frame& frame, float time_s, const deform::Points& vertices) {
    for (auto kind = exact_.begin(); kind != exact_.end();) {
      if ((*kind)->add(frame, time_s, vertices)) {
        ++kind;
        continue;
      }
      if (exact_.size() == 1) {
        keys_.emplace(job_, tolerance_, (*kind)->greatest_error(), document_.file);
        if (auto given = (*kind)->give_frames(*keys_); !given) return given;
      }
      kind = exact_.erase(kind);
    }
    if (!keys_) return {};
    const deform::Points& original = job_.frames.source().layout(frame.model).original();
    return keys_->add(frame.model, time_s, (vertices - original).cast<float>());
  }

  /// Writes the file. Errors: those of KeyShapeModels::finish() and finish_models().
  Result<Exported> finish(const Played& played) {
    MorphReport report;
    report.has_puppet = has_puppet_;
    if (!keys_) {
      report.basis = exact_.front()->basis();
      const auto models = exact_.front()->make_models(document_.file);
      return finish_models(job_, played, models, report, document_);
    }
    const auto models = keys_->finish();
    if (!models) return models.error();
    report.tolerance = tolerance_ / diagonal_;
    return finish_models(job_, played, *models, report, document_);
  }

private:
  const GltfJob& job_;
  bool has_puppet_;
  double diagonal_ = 0.0;  ///< the model's, model units
  double tolerance_ = 0.0; ///< error limit of key shapes, model units
  GltfTake document_;
  std::vector<std::unique_ptr<ExactMorphs>> exact_; ///< the kinds that give all frames so far
  std::optional<KeyShapeModels> keys_;              ///< once there are none of these
};

Result<Exported> export_model(const GltfJob& job, bool has_puppet) {
  TakeMorphs morphs(job, has_puppet);
  const auto played =
      play_frames(job, [&](const flow::Frame& frame, float time_s, const deform::Points& vertices) {
        return morphs.add(frame, time_s, vertices);
      });
  if (!played) return played.error();
  return morphs.finish(*played);
}

/// A take without a model.
Result<Exported> export_hands(const GltfJob& job) {
  const auto played = play_frames(
      job, [](const flow::Frame&, float, const deform::Points&) -> Result<void> { return {}; });
  if (!played) return played.error();
  if (!played->hands[0] && !played->hands[1])
    return Error{Errc::bad_input,
                 job.path.string() + ": there would be neither a model nor a hand in it"};
  GltfTake document(job.options);
  return finish_take(job, *played, GlbFile::Json::array(), document);
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

Result<Exported> export_gltf(takes::FrameSource& source, const Choice& choice,
                             const GltfOptions& options, const std::filesystem::path& path) {
  const bool has_model = source.model(0).vertices.cols() > 0;
  const bool has_puppet = source.puppet().has_value();
  auto frames = ChosenFrames::make(source, choice);
  if (!frames) return frames.error();
  const GltfJob job{*frames, options, path};
  return has_model ? export_model(job, has_puppet) : export_hands(job);
}

} // namespace nendo::exporting
