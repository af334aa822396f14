#include "export/gltf_keys.hpp"

#include <algorithm>
#include <utility>

namespace nendo::exporting {

KeyShapeModels::KeyShapeModels(const GltfJob& job, double tolerance, double frame_error,
                               GlbFile& file)
    : job_(job), tolerance_(tolerance), frame_error_(frame_error), file_(file) {}

Result<void> KeyShapeModels::add(std::uint32_t version, float time_s,
                                 Eigen::Matrix3Xf displacement) {
  if (auto fine = job_.frames.check_stop(); !fine) return fine;
  if (models_.empty() || models_.back().version != version) begin_model(version);
  keys_->add(time_s, std::move(displacement));
  return check_weights();
}

Result<std::vector<MovingModel>> KeyShapeModels::finish() {
  end_model();
  if (const auto fine = check_weights(); !fine) return fine.error();
  return std::move(models_);
}

void KeyShapeModels::begin_model(std::uint32_t version) {
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

void KeyShapeModels::end_model() {
  if (!keys_) return;
  keys_->finish();
  models_.back().greatest_error = keys_->greatest_error() + rest_error_;
  keys_.reset();
}

Result<void> KeyShapeModels::check_weights() const {
  std::uint64_t weights = 0;
  for (const MovingModel& one : models_)
    weights += one.model.key_weight_count();
  if (weights <= job_.options.max_weights) return {};
  return Error{Errc::failed, job_.path.string() + ": needs more key shapes than programs can read; "
                                                  "use a greater --tolerance, a lower --rate, or "
                                                  "--from and --to"};
}

} // namespace nendo::exporting
