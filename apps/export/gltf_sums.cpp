#include "export/gltf_sums.hpp"

#include <algorithm>
#include <utility>

#include <nendo/deform/triangles.hpp>

#include "export/control_morphs.hpp"
#include "export/function_morphs.hpp"

namespace nendo::exporting {
namespace {

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

} // namespace

std::unique_ptr<ExactMorphs> morphs_by_functions(const ChosenFrames& frames) {
  return std::make_unique<FunctionModels>(frames);
}

std::unique_ptr<ExactMorphs> morphs_by_control_vectors(const takes::FrameSource& source) {
  Eigen::VectorXd weights;
  if (const puppet::Rig* const masks = source.masks())
    weights = puppet::mask_weights(masks->puppet(), source.layout(source.frame().model).original());
  return std::make_unique<ControlModel>(source, std::move(weights));
}

} // namespace nendo::exporting
