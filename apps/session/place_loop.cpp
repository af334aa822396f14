#include "session/place_loop.hpp"

#include <algorithm>
#include <utility>

#include <nendo/deform/midpoint_chain.hpp>
#include <nendo/flow/finger_supports.hpp>
#include <nendo/flow/sculptor.hpp>
#include <nendo/flow/setting.hpp>
#include <nendo/hand/held_points.hpp>
#include <nendo/puppet/puppet_edit.hpp>
#include <nendo/sculpting/placing.hpp>

namespace nendo::session {
namespace {

std::vector<flow::HandInput> inputs_of(const std::vector<gloves::OpenHand>& hands,
                                       const RunOptions& options) {
  std::vector<flow::HandInput> inputs;
  inputs.reserve(hands.size());
  for (const auto& hand : hands) {
    inputs.push_back(sculpting::input_of(hand));
    inputs.back().filter = options.filter;
    if (!options.over) { // a take's wrists are its own
      inputs.back().wrist_path = hand.wrist_path;
      if (hand.wrist) inputs.back().wrist_source = {hand.wrist->ring.get(), hand.wrist->tracking};
    }
    if (options.live)
      inputs.back().layer.emplace().joints = (*options.live)[flow::Placement::index_of(hand.side)];
  }
  return inputs;
}

flow::Placement placement_for(const std::vector<gloves::OpenHand>& open,
                              const std::vector<flow::HandInput>& inputs, const deform::Mesh& model,
                              const RunOptions& options) {
  if (options.hands_only) return flow::place_without_model();
  const bool is_for_player = options.puppet || !options.puppet_file.empty();
  flow::Placement placement = sculpting::place(
      model, inputs, {options.loop.sculptor.mode, options.model_size_m, is_for_player});
  for (const auto& hand : open) {
    if (hand.T_stage_wrist)
      placement.T_stage_wrist[flow::Placement::index_of(hand.side)] = *hand.T_stage_wrist;
  }
  return placement;
}

Error bad_radius(const std::string& why) {
  return {Errc::usage, "--radius " + why};
}

Result<deform::Supports> supports_for(const std::optional<deform::Supports>& of_two,
                                      std::size_t hands, flow::Mode mode,
                                      const deform::Mesh& model) {
  if (!of_two) return sculpting::usual_supports(model, mode);
  auto supports = flow::supports_of_hands(*of_two, static_cast<int>(hands));
  if (!supports) return bad_radius(supports.error().message);
  return supports;
}

/// The limits are on the stage, where the model's size is known.
Result<void> check_radii(const RunOptions& options, const deform::Supports& supports,
                         double units_per_metre) {
  flow::LoopSettings settings;
  settings.radius_m = flow::radii_on_stage(supports, units_per_metre);
  if (const auto fine = flow::check_ranges(settings); !fine)
    return bad_radius(options.radius + ": " + fine.error().message);
  return {};
}

/// Puts the puppet into the options. Error: bad_input, naming its file.
Result<void> set_rig(const RunOptions& options, const deform::Mesh& model,
                     flow::LoopOptions& loop) {
  if (const auto fits = puppet::check_fits(*options.puppet, model); !fits) return fits;
  loop.rig = std::make_shared<const puppet::Rig>(*options.puppet, model);
  loop.sculptor.deformer.supports = loop.rig->supports();
  auto surface = flow::surface_for(*loop.rig, model, deform::BlockLayout(model.vertices),
                                   loop.sculptor.deformer);
  if (!surface)
    return Error{surface.error().code, options.puppet_file + ": " + surface.error().message};
  loop.sculptor.surface = *std::move(surface);
  return {};
}

/// Puts the fingertips' masks, and the mirror, into the options.
Result<void> set_masks(const RunOptions& options, const deform::Mesh& model, Eigen::Index tips,
                       flow::LoopOptions& loop) {
  if (!options.masks && !options.symmetric) return {};
  const deform::Points no_points(3, 0);
  puppet::Puppet masks = options.masks.value_or(puppet::Puppet{});
  if (options.symmetric && !masks.mirrors) {
    auto mirrored = puppet::with_symmetry(puppet::Rig(masks, no_points), true,
                                          puppet::plane_of_symmetry(model.vertices));
    if (!mirrored) return mirrored.error();
    masks = *std::move(mirrored);
  }
  if (masks.mirrors)
    loop.sculptor.deformer.supports =
        flow::of_both_sides(std::move(loop.sculptor.deformer.supports), tips);
  loop.rig = std::make_shared<const puppet::Rig>(std::move(masks), no_points);
  return {};
}

Result<PlacedLoop> make_loop(PlacedSetup setup, const deform::Mesh& model,
                             const deform::BlockShape* first) {
  auto loop = sculpting::make_loop(model, setup.placement, setup.inputs, setup.options, first);
  if (!loop) return loop.error();
  return PlacedLoop{*std::move(loop), std::move(setup)};
}

/// Makes the loop of the take, whose hands keep their places.
Result<PlacedLoop> place_over(const RunOptions& options, const std::vector<gloves::OpenHand>& hands,
                              const deform::Mesh& model) {
  const recording::Setup& take = options.over->take.setup;
  auto inputs = inputs_of(hands, options);
  const auto joining = placement_for(hands, inputs, model, options);
  if (const auto played = play_over(options, inputs); !played) return played.error();
  PlacedSetup setup{std::move(inputs), take.loop->placement, options.loop};
  const Eigen::Index points = setup.options.rig ? setup.options.rig->starts().cols() : 0;
  for (const auto& [number, puppet] : options.over->take.puppets)
    setup.spare_points = std::max(setup.spare_points, puppet->starts.cols() - points);
  for (const auto& hand : hands) {
    const std::size_t slot = flow::Placement::index_of(hand.side);
    if (!has_hand(take, hand.side))
      setup.placement.T_stage_wrist[slot] = joining.T_stage_wrist[slot];
  }
  const puppet::Rig* const rig = setup.options.rig.get();
  if (!flow::is_played(rig) && flow::count_hands(setup.inputs) > flow::count_hands(take.hands)) {
    deform::Supports& supports = setup.options.sculptor.deformer.supports;
    if (flow::mirror_of(rig)) supports = flow::of_one_side(std::move(supports), 5);
    // The radii of the hand that joins are those of the hand that was there alone.
    supports = flow::of_both_sides(std::move(supports), 5);
    if (flow::mirror_of(rig)) supports = flow::of_both_sides(std::move(supports), 10);
  }
  const deform::BlockShape first(take.loop->rest);
  return make_loop(std::move(setup), model, first.block_count() > 0 ? &first : nullptr);
}

} // namespace

Result<std::optional<deform::Supports>> parse_radius(const std::string& text,
                                                     double units_per_metre) {
  if (text.empty()) return std::optional<deform::Supports>();
  auto supports = flow::parse_finger_supports(text, units_per_metre);
  if (!supports) return bad_radius(supports.error().message);
  return std::optional(*std::move(supports));
}

std::uint32_t PlacedSetup::live_layers() const noexcept {
  std::uint32_t layers = 0;
  for (std::size_t at = 0; at < inputs.size(); ++at)
    if (inputs[at].ring != nullptr && inputs[at].layer) layers |= 1U << at;
  return layers;
}

Result<PlacedLoop> place_loop(const RunOptions& options, const std::vector<gloves::OpenHand>& hands,
                              const deform::Mesh& model) {
  if (options.over) return place_over(options, hands, model);
  flow::LoopOptions loop_options = options.loop;
  auto inputs = inputs_of(hands, options);
  const auto placement = placement_for(hands, inputs, model, options);
  const auto of_two = parse_radius(options.radius, placement.units_per_metre);
  if (!of_two) return of_two.error();
  auto supports = supports_for(*of_two, inputs.size(), options.loop.sculptor.mode, model);
  if (!supports) return supports.error();
  if (const auto fine = check_radii(options, *supports, placement.units_per_metre); !fine)
    return fine.error();
  sculpting::set_supports(*std::move(supports), loop_options.sculptor);

  const auto fine =
      options.puppet
          ? set_rig(options, model, loop_options)
          : set_masks(options, model, 5 * static_cast<Eigen::Index>(inputs.size()), loop_options);
  if (!fine) return fine.error();
  constexpr Eigen::Index points_to_add = 64;
  PlacedSetup setup{inputs, placement, loop_options,
                    options.out_puppet.file.empty() ? 0 : points_to_add};
  return make_loop(std::move(setup), model, nullptr);
}

flow::FrameCapacity frame_capacity(const PlacedLoop& placed) {
  const auto& rig = placed.setup.options.rig;
  const bool is_played = flow::is_played(rig.get());
  const auto hands = static_cast<Eigen::Index>(flow::count_hands(placed.setup.inputs));
  const Eigen::Index spare = placed.setup.spare_points;
  // Fingertips may shape both sides from some time on.
  const Eigen::Index points = (is_played ? rig->starts().cols() : 10 * hands) + spare;
  const auto& deformer = placed.setup.options.sculptor.deformer;
  // A radius for each finger: a function that is its own, and one that all share.
  const Eigen::Index functions = std::max(deformer.supports.functions(points) + spare, 2 * points);
  const int links = std::max(deformer.injective.value_or(deform::InjectiveOptions{}).max_links,
                             deform::Type2Deformer::max_pieces);
  const int fields = std::max(links, deform::max_midpoint_fields);
  // The whole hand may hold, which has more points and fewer fields.
  const Eigen::Index all_over =
      is_played ? 0 : 2 * static_cast<Eigen::Index>(hand::held_point_count) * hands;
  return {static_cast<std::size_t>(fields),
          static_cast<std::size_t>(std::max(functions, all_over * links / fields + 1)),
          static_cast<std::size_t>(is_played || spare > 0 ? 2 * points : 0)};
}

} // namespace nendo::session
