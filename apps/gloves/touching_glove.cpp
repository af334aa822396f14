#include "gloves/touching_glove.hpp"

#include <string>

#include "cli/cli.hpp"

namespace nendo::gloves {
namespace {

void tell_idle_fingers(const std::string& spec, const flow::TouchingHand& hand) {
  std::string idle;
  for (std::size_t at = 0; at < hand::finger_count; ++at) {
    const auto finger = static_cast<hand::Finger>(at);
    if (!hand.touches(finger)) idle.append(idle.empty() ? "" : ", ").append(name_of(finger));
  }
  if (!idle.empty()) cli::note(spec + ": keeps still what does not reach the model: " + idle);
}

} // namespace

driver::GloveContext touching_context(const deform::Mesh& model, std::optional<Side> side,
                                      const hand::HandSize& size,
                                      std::optional<Eigen::Isometry3d>& T_stage_wrist) {
  const auto motion =
      [=, &model, &T_stage_wrist](
          const driver::SimulatedGloveOptions& options) -> Result<driver::SensorMotion> {
    flow::TouchOptions touch;
    touch.seed = options.seed;
    const hand::HandSkeleton skeleton(side.value_or(options.side), size);
    const auto hand = flow::TouchingHand::make(model, skeleton, touch);
    if (!hand) {
      return Error{hand.error().code, options.source + ": " + hand.error().message +
                                          "; choose another model, or another motion, like "
                                          "sim:sculpt"};
    }
    tell_idle_fingers(options.source, *hand);
    T_stage_wrist = hand->wrist_pose();
    return driver::SensorMotion(
        [hand = *hand](double time_s) { return hand.sensor_angles(time_s); });
  };
  return {motion};
}

} // namespace nendo::gloves
