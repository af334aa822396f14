#include "timeline/point_sway.hpp"

#include <algorithm>
#include <cmath>

namespace nendo::timeline {

PointSway::PointSway(const Timeline& timeline, Side side) {
  if (!timeline.rig) return;
  bool is_symmetric = timeline.rig_state.symmetric;
  for (const Event& event : timeline.events) {
    const auto* symmetry = std::get_if<flow::SetSymmetry>(&event.command);
    is_symmetric = is_symmetric || (symmetry != nullptr && symmetry->on);
    if (!std::holds_alternative<flow::Mark>(event.command)) held_at_s_.push_back(event.time_s);
  }
  reach_m_.resize(timeline.point_count(), 0);
  const auto& functions = timeline.rig_state.functions;
  for (std::size_t at = 0; at < functions.size(); ++at)
    if (functions[at].input.side() == side) add(timeline, at, functions[at].input, is_symmetric);
  for (const Event& event : timeline.events)
    if (const auto* role = std::get_if<flow::SetRole>(&event.command);
        role != nullptr && role->input.side() == side)
      add(timeline, role->function, role->input, is_symmetric);
}

void PointSway::add(const Timeline& timeline, std::size_t function, const puppet::HandSignal& input,
                    bool moves_twin) {
  const puppet::Puppet& puppet = timeline.rig->puppet();
  Eigen::VectorXd reach = timeline.rig->vectors_of(function).colwise().norm();
  const auto twin = puppet.function_named(puppet::twin_of(puppet.functions[function].name));
  if (moves_twin && twin && *twin != function)
    reach += timeline.rig->vectors_of(*twin).colwise().norm().transpose();
  reach /= std::abs(puppet.functions[function].travel) * timeline.units_per_metre;
  inputs_.push_back(input);
  reach_m_.conservativeResize(Eigen::NoChange, reach_m_.cols() + 1);
  reach_m_.rightCols<1>() = reach;
}

Eigen::VectorXd PointSway::signals(const puppet::HandState& hand) const {
  Eigen::VectorXd signals(static_cast<Eigen::Index>(inputs_.size()));
  for (std::size_t at = 0; at < inputs_.size(); ++at)
    signals[static_cast<Eigen::Index>(at)] = inputs_[at].of(hand);
  return signals;
}

double PointSway::off_m(const Eigen::VectorXd& one, const Eigen::VectorXd& other) const {
  if (inputs_.empty()) return 0.0;
  return (reach_m_ * (one - other).cwiseAbs()).maxCoeff();
}

} // namespace nendo::timeline
