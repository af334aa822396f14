#include "export/gltf_export.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <nendo/deform/triangles.hpp>

#include "export/gltf_animation.hpp"
#include "export/morphs.hpp"

namespace nendo::exporting {
namespace {

/// The models of a take, one for each version, whose targets are key shapes.
class KeyShapeModels {
public:
  /// Puts models and targets into `file` as frames are added. `job` and `file` must outlive this.
  /// In model units, a vertex may be off by `tolerance`, of which `frame_error` is how far those of
  /// the frames are off before they are added.
  KeyShapeModels(const GltfJob& job, double tolerance, double frame_error, GlbFile& file)
      : job_(job), tolerance_(tolerance), frame_error_(frame_error), file_(file) {}
  KeyShapeModels(const KeyShapeModels&) = delete; // keys_ refers to it
  KeyShapeModels& operator=(const KeyShapeModels&) = delete;

  /// Adds the next frame: the version of its model, its time since the first frame, and how far its
  /// vertices are from the model at rest (3 by #vertices, in the mesh's order). Errors: failed (the
  /// export was stopped, or there are more weights than GltfOptions::max_weights).
  Result<void> add(std::uint32_t version, float time_s, Eigen::Matrix3Xf displacement) {
    if (auto fine = job_.frames.check_stop(); !fine) return fine;
    if (models_.empty() || models_.back().version != version) begin_model(version);
    keys_->add(time_s, std::move(displacement));
    return check_weights();
  }

  /// Returns the models, of which there must be one. Nothing may be added afterwards. Errors:
  /// failed (too many weights).
  Result<std::vector<MovingModel>> finish() {
    end_model();
    if (const auto fine = check_weights(); !fine) return fine.error();
    return std::move(models_);
  }

private:
  void begin_model(std::uint32_t version) {
    end_model();
    const takes::FrameSource& source = job_.frames.source();
    models_.push_back({GltfModel(source.model(version), file_), version});
    // A reader adds targets to a rest shape that is rounded to floats. The error of the frames
    // includes that.
    const deform::Points& rest = source.layout(version).original();
    const double rounding = (rest.cast<float>().cast<double>() - rest).colwise().norm().maxCoeff();
    rest_error_ = std::max(rounding, frame_error_);
    const double tolerance = std::max(0.0, tolerance_ - (rest_error_ - rounding));
    keys_.emplace(tolerance, [this](float time_s, const KeyShapes::Shape& displacement) {
      models_.back().times_s.push_back(time_s);
      models_.back().model.add_key_target(displacement, file_);
    });
  }

  void end_model() {
    if (!keys_) return;
    keys_->finish();
    models_.back().greatest_error = keys_->greatest_error() + rest_error_;
    keys_.reset();
  }

  Result<void> check_weights() const {
    std::uint64_t weights = 0;
    for (const MovingModel& one : models_)
      weights += one.model.key_weight_count();
    if (weights <= job_.options.max_weights) return {};
    return Error{Errc::failed, job_.path.string() +
                                   ": needs more key shapes than programs can read; "
                                   "use a greater --tolerance, a lower --rate, or "
                                   "--from and --to"};
  }

  const GltfJob& job_;
  double tolerance_;
  double frame_error_;
  GlbFile& file_;
  std::vector<MovingModel> models_;
  double rest_error_ = 0.0;       ///< max error of the last model's frames, before keys are chosen
  std::optional<KeyShapes> keys_; ///< the last model's
};

/// Morph targets of which the shapes of a take are weighted sums, exactly.
class ExactMorphs {
public:
  virtual ~ExactMorphs() = default;
  virtual MorphBasis basis() const noexcept = 0;
  /// Adds the next frame, its time since the first, and its vertices in the mesh's order. Returns
  /// false if its shape is no such sum. The frames before remain, and no other may be added then.
  virtual bool add(const flow::Frame& frame, float time_s, const deform::Points& vertices) = 0;
  /// Returns the greatest error of a vertex over the frames, in model units.
  virtual double greatest_error() const noexcept = 0;
  /// Adds the frames to `keys`, each as the sum that it is. Errors: those of KeyShapeModels::add().
  virtual Result<void> give_frames(KeyShapeModels& keys) const = 0;
  /// Puts the models with their targets into `file`, and returns them in the order of time. Nothing
  /// else may be called afterwards.
  virtual std::vector<MovingModel> make_models(GlbFile& file) = 0;
};

/// The model of each puppet on each version of its model.
class FunctionModels final : public ExactMorphs {
public:
  explicit FunctionModels(const ChosenFrames& frames) : frames_(frames) {}

  MorphBasis basis() const noexcept override { return MorphBasis::functions; }

  bool add(const flow::Frame& frame, float time_s, const deform::Points& vertices) override {
    const bool goes_on = !parts_.empty() && frame.puppet == parts_.back().puppet &&
                         frame.model == parts_.back().version;
    if (!goes_on && !begin(frame, vertices)) return false;
    if (!parts_.back().morphs.add(frame, vertices)) return false;
    parts_.back().times_s.push_back(time_s);
    return true;
  }

  double greatest_error() const noexcept override {
    double greatest = 0.0;
    for (const Part& part : parts_)
      greatest = std::max(greatest, part.morphs.greatest_error());
    return greatest;
  }

  Result<void> give_frames(KeyShapeModels& keys) const override {
    for (const Part& part : parts_) {
      const deform::Points& original = frames_.source().layout(part.version).original();
      const Eigen::Matrix3Xf rest = part.morphs.rest() - original.cast<float>();
      for (std::size_t at = 0; at < part.times_s.size(); ++at) {
        auto added = keys.add(part.version, part.times_s[at], rest + part.morphs.displacement(at));
        if (!added) return added;
      }
    }
    return {};
  }

  std::vector<MovingModel> make_models(GlbFile& file) override {
    std::vector<MovingModel> models;
    for (Part& ended : parts_) {
      const Part part = std::move(ended); // its targets then are not kept beside those in the file
      const deform::Mesh mesh =
          deform::in_shape(frames_.source().model(part.version), part.morphs.rest().cast<double>());
      models.push_back({GltfModel(mesh, file), part.version, part.times_s, part.morphs.weights(),
                        part.morphs.greatest_error()});
      models.back().model.add_function_targets(part.morphs, file);
    }
    return models;
  }

private:
  struct Part {
    FunctionMorphs morphs;
    std::uint32_t puppet; ///< Frame::puppet
    std::uint32_t version;
    std::vector<float> times_s{};
  };

  bool begin(const flow::Frame& frame, const deform::Points& vertices) {
    const auto puppet = frames_.puppet();
    if (!puppet) return false;
    const deform::BlockLayout& layout = frames_.source().layout(frame.model);
    auto morphs = FunctionMorphs::make(*puppet, layout, frame, vertices);
    if (!morphs) return false;
    parts_.push_back({*std::move(morphs), frame.puppet, frame.model});
    return true;
  }

  const ChosenFrames& frames_;
  std::vector<Part> parts_;
};

class ControlModel final : public ExactMorphs {
public:
  ControlModel(const takes::FrameSource& source, Eigen::VectorXd weights)
      : source_(source), version_(source.frame().model),
        morphs_(source.layout(version_), std::move(weights)) {}

  MorphBasis basis() const noexcept override { return MorphBasis::control_vectors; }

  bool add(const flow::Frame& frame, float time_s, const deform::Points& vertices) override {
    if (!morphs_.add(frame, vertices)) return false;
    times_s_.push_back(time_s);
    return true;
  }

  double greatest_error() const noexcept override { return morphs_.greatest_error(); }

  Result<void> give_frames(KeyShapeModels& keys) const override {
    for (std::size_t at = 0; at < times_s_.size(); ++at)
      if (auto added = keys.add(version_, times_s_[at], morphs_.displacement(at)); !added)
        return added;
    return {};
  }

  std::vector<MovingModel> make_models(GlbFile& file) override {
    std::vector<MovingModel> models;
    models.push_back({GltfModel(source_.model(version_), file), version_, std::move(times_s_)});
    models.back().weights = models.back().model.add_control_targets(morphs_, file);
    models.back().greatest_error = morphs_.greatest_error();
    return models;
  }

private:
  const takes::FrameSource& source_;
  std::uint32_t version_;
  ControlMorphs morphs_;
  std::vector<float> times_s_;
};

/// `source` must be at the first frame and outlive the result.
std::unique_ptr<ExactMorphs> morphs_by_control_vectors(const takes::FrameSource& source) {
  Eigen::VectorXd weights;
  if (const puppet::Rig* const masks = source.masks())
    weights = puppet::mask_weights(masks->puppet(), source.layout(source.frame().model).original());
  return std::make_unique<ControlModel>(source, std::move(weights));
}

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
    if (has_puppet) exact_.push_back(std::make_unique<FunctionModels>(job.frames));
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

  /// Writes the file. Errors: those of KeyShapeModels::finish() and write_models().
  Result<Exported> finish(const PlayedFrames& played) {
    MorphReport report;
    report.has_puppet = has_puppet_;
    if (!keys_) {
      report.basis = exact_.front()->basis();
      const auto models = exact_.front()->make_models(document_.file);
      return write_models(job_, played, models, report, document_);
    }
    const auto models = keys_->finish();
    if (!models) return models.error();
    report.tolerance = tolerance_ / diagonal_;
    return write_models(job_, played, *models, report, document_);
  }

private:
  const GltfJob& job_;
  bool has_puppet_;
  double diagonal_ = 0.0;  ///< the model's, model units
  double tolerance_ = 0.0; ///< error limit of key shapes, model units
  GltfAnimation document_;
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
  GltfAnimation document(job.options);
  return write_hands(job, *played, GlbFile::Json::array(), document);
}

} // namespace

std::string_view name_of(MorphBasis basis) noexcept {
  constexpr std::array<std::string_view, 3> names{"key shapes", "control vectors", "functions"};
  return names[static_cast<std::size_t>(basis)];
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
