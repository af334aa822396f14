#include "motions/planned_hand.hpp"

#include <string>
#include <utility>

#include "cli/cli.hpp"
#include "motions/kneading_hand.hpp"
#include "motions/touching_hand.hpp"

namespace nendo::motions {
namespace {

using driver::SensorMotion;
using driver::SimulatedGloveOptions;

void note_idle_fingers(const std::string& spec, const TouchingHand& hand) {
  std::string idle;
  for (std::size_t at = 0; at < hand::finger_count; ++at) {
    const auto finger = static_cast<hand::Finger>(at);
    if (!hand.touches(finger)) idle.append(idle.empty() ? "" : ", ").append(name_of(finger));
  }
  if (!idle.empty()) cli::note(spec + ": keeps still what does not reach the model: " + idle);
}

Result<SensorMotion> kneading_motion(const SimulatedGloveOptions& options, KneadTask task,
                                     PlannedHand& planned) {
  const hand::HandSkeleton skeleton(planned.side.value_or(options.side), planned.size);
  auto hand = KneadingHand::make(planned.model, skeleton, task, planned.model_size_m);
  if (!hand) return Error{hand.error().code, options.source + ": " + hand.error().message};
  planned.wrist_path = hand->wrist();
  planned.T_stage_wrist = hand->wrist()->at(0.0);
  return SensorMotion(
      [hand = *std::move(hand)](double time_s) { return hand.sensor_angles(time_s); });
}

Result<SensorMotion> touching_motion(const SimulatedGloveOptions& options, PlannedHand& planned) {
  TouchOptions touch;
  touch.seed = options.seed;
  touch.model_size_m = planned.model_size_m;
  const hand::HandSkeleton skeleton(planned.side.value_or(options.side), planned.size);
  const auto hand = TouchingHand::make(planned.model, skeleton, touch);
  if (!hand) {
    return Error{hand.error().code, options.source + ": " + hand.error().message +
                                        "; choose another model, or another motion, like "
                                        "sim:sculpt"};
  }
  note_idle_fingers(options.source, *hand);
  planned.T_stage_wrist = hand->wrist_pose();
  return SensorMotion([hand = *hand](double time_s) { return hand.sensor_angles(time_s); });
}

template <class Make>
driver::NamedMotion named(std::string_view name, PlannedHand* hand, Make make) {
  return {name, [hand, make](const SimulatedGloveOptions& options) -> Result<SensorMotion> {
            if (hand != nullptr) return make(options, *hand);
            return Error{Errc::usage, options.source +
                                          ": needs a model to touch, which only nendo run and "
                                          "nendo stress have; use another motion here, like "
                                          "sim:sculpt"};
          }};
}

} // namespace

std::vector<driver::NamedMotion> planned_motions(PlannedHand* hand) {
  std::vector<driver::NamedMotion> motions{named("touch", hand, touching_motion)};
  for (const KneadTask task : knead_tasks)
    motions.push_back(named(name_of(task), hand,
                            [task](const SimulatedGloveOptions& options, PlannedHand& planned) {
                              return kneading_motion(options, task, planned);
                            }));
  return motions;
}

} // namespace nendo::motions
