#include "session/place_loop.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include <nendo/flow/finger_supports.hpp>

namespace nendo::session {
namespace {

// A fraction of the model's longest side, 16 cm on the stage. A finger shapes what is about it, and
// the supports of its neighbours overlap enough that no ridge is left between two fingers that
// press together.
constexpr double default_radius_fraction = 0.2;
// The length of a piece of type 2, as a fraction of the radius. It is far below the step at which a
// single finger would fold the surface (0.47).
constexpr double piece_fraction = 0.05;

std::vector<flow::HandInput> inputs_of(const std::vector<gloves::OpenHand>& hands,
                                       const RunOptions& options,
                                       const std::optional<Carryover>& carryover) {
  std::vector<flow::HandInput> inputs;
  inputs.reserve(hands.size());
  for (const auto& hand : hands) {
    inputs.push_back({hand.ring.get(), hand.side, hand.wearer, hand.first});
    inputs.back().filter = options.filter;
    if (carryover)
      inputs.back().wearer.learned = carryover->learned[flow::Placement::index_of(hand.side)];
  }
  return inputs;
}

flow::Placement placement_for(const std::vector<gloves::OpenHand>& open,
                              const std::vector<flow::HandInput>& inputs,
                              const deform::Mesh& model) {
  std::array<std::optional<flow::Fingertips>, 2> tips;
  for (const auto& hand : inputs) {
    const Side glove = hand.first.side;
    const auto angles = hand::joint_angles(hand.first, hand.wearer.of(glove).calibration);
    tips[flow::Placement::index_of(hand.side)] =
        hand.skeleton(glove).pose(angles, Eigen::Isometry3d::Identity()).fingertip_positions();
  }
  flow::Placement placement = flow::place_hands(model, tips);
  for (const auto& hand : open) {
    if (hand.T_stage_wrist)
      placement.T_stage_wrist[flow::Placement::index_of(hand.side)] = *hand.T_stage_wrist;
  }
  return placement;
}

double longest_side(const deform::Mesh& model) {
  return (model.vertices.rowwise().maxCoeff() - model.vertices.rowwise().minCoeff()).maxCoeff();
}

Error bad_radius(const std::string& text, const std::string& why) {
  return {Errc::usage, "--radius" + text + ": " + why +
                           "; use a length > 0 in the mesh's units, five with commas between (or "
                           "ten, left hand first), or leave it out"};
}

Result<deform::Supports> supports_for(const std::optional<deform::Supports>& of_two,
                                      std::size_t hands, double model_size) {
  if (!of_two)
    return deform::one_radius(default_radius_fraction * (model_size > 0.0 ? model_size : 1.0));
  auto supports = flow::supports_of_hands(*of_two, static_cast<int>(hands));
  if (!supports) return bad_radius("", "is for two hands, and there is one");
  return *std::move(supports);
}

std::pair<double, double> least_and_largest(const deform::Supports& supports) {
  double least = supports.shared.front().radius;
  double largest = least;
  const auto count = [&](const deform::Support& support) {
    least = std::min(least, support.radius);
    largest = std::max(largest, support.radius);
  };
  for (const auto& support : supports.shared)
    count(support);
  for (const auto& own : supports.own)
    count(own.support);
  return {least, largest};
}

} // namespace

Carryover carryover_of(const flow::DeformLoop& ended) {
  return {ended.placement(), ended.learned()};
}

Result<std::optional<deform::Supports>> parse_radius(const std::string& text) {
  if (text.empty()) return std::optional<deform::Supports>();
  auto supports = flow::parse_finger_supports(text);
  if (!supports) return bad_radius(" " + text, "is not a number above 0, nor a list of them");
  return supports;
}

Result<PlacedLoop> place_loop(const RunOptions& options, const std::vector<gloves::OpenHand>& hands,
                              const deform::Mesh& model,
                              const std::optional<Carryover>& carryover) {
  const double size = longest_side(model);
  flow::LoopOptions loop_options = options.loop;
  auto& sculptor = loop_options.sculptor;
  auto inputs = inputs_of(hands, options, carryover);
  auto supports = supports_for(options.supports, inputs.size(), size);
  if (!supports) return supports.error();
  const auto [least_radius, largest_radius] = least_and_largest(*supports);
  sculptor.deformer.supports = *std::move(supports);
  sculptor.piece_length = piece_fraction * least_radius;
  // Live fingertips meet; the exact solution for two that nearly touch would tear the surface
  // between them.
  sculptor.deformer.csrbf.merge_fraction = 0.05;

  const auto placement = carryover ? carryover->placement : placement_for(hands, inputs, model);
  PlacedSetup setup{inputs, placement, loop_options};
  auto loop = std::make_unique<flow::DeformLoop>(model, placement, std::move(inputs), loop_options);
  if (!is_solved(loop->grab_status())) {
    return Error{Errc::failed, "the hands cannot take hold of the model: " +
                                   std::string(deform::describe(loop->grab_status()))};
  }
  return PlacedLoop{std::move(loop), largest_radius, std::move(setup), options.recording.on};
}

FrameCapacity frame_capacity(const PlacedLoop& placed) {
  const auto points = 5 * static_cast<Eigen::Index>(placed.setup.inputs.size());
  const auto& supports = placed.setup.options.sculptor.deformer.supports;
  return {placed.loop->frames().front().fields.room(),
          static_cast<std::size_t>(supports.functions(points))};
}

} // namespace nendo::session
