#include "gloves/touching_glove.hpp"

#include <utility>

#include <nendo/driver/simulated_glove.hpp>

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

bool is_touching(const std::string& spec) {
  const auto parsed = driver::parse_glove_spec(spec);
  return parsed && parsed->kind == "sim" && parsed->target == driver::touching_motion;
}

Result<TouchingGlove> open_touching_glove(const std::string& spec, std::optional<Side> side,
                                          const deform::Mesh& model, const hand::HandSize& size) {
  const auto parsed = driver::parse_glove_spec(spec);
  if (!parsed) return parsed.error();
  const auto options = driver::simulated_glove_options(*parsed, side);
  if (!options) return options.error();
  flow::TouchOptions touch;
  touch.seed = options->seed;
  const hand::HandSkeleton skeleton(side.value_or(options->side), size);
  const auto hand = flow::TouchingHand::make(model, skeleton, touch);
  if (!hand) {
    return Error{hand.error().code, spec + ": " + hand.error().message +
                                        "; choose another model, or another motion, like "
                                        "sim:sculpt"};
  }
  tell_idle_fingers(spec, *hand);
  return TouchingGlove{
      driver::make_simulated_glove(
          *options, [hand = *hand](double time_s) { return hand.sensor_angles(time_s); }),
      hand->wrist_pose()};
}

} // namespace nendo::gloves
