#include "session/open_hands.hpp"

#include <algorithm>
#include <utility>

#include <nendo/deform/mesh.hpp>

#include "cli/cli.hpp"

namespace nendo::session {
namespace {

bool plays(const RunOptions& options, Side side) {
  return !options.live || !(*options.live)[flow::Placement::index_of(side)].is_empty();
}

Result<std::vector<gloves::OpenHand>> open_any(const RunOptions& options, EventCount* event_count) {
  std::vector<Side> sides;
  for (const Side side : {Side::left, Side::right})
    if (plays(options, side)) sides.push_back(side);
  return sculpting::open_found(
      sides, options.puppet_file.empty() ? "sim" : "sim:faces",
      [event_count](const std::string& glove, Side side) {
        return gloves::open_hand(glove, side, event_count);
      },
      cli::note);
}

Result<std::vector<gloves::OpenHand>>
open_named(const RunOptions& options, const deform::Mesh& whole, EventCount* event_count) {
  const auto faces = deform::without_stray_vertices(whole);
  const deform::Mesh& model = faces ? *faces : whole;
  std::vector<gloves::OpenHand> hands;
  for (const auto& [spec, side] :
       {std::pair{&options.left, Side::left}, {&options.right, Side::right}}) {
    if (spec->empty()) continue;
    motions::PlannedHand planned{model, options.model_size_m, side, options.length.size({})};
    auto hand = gloves::open_hand(*spec, side, event_count, &planned);
    if (!hand) return hand.error();
    hand->T_stage_wrist = planned.T_stage_wrist;
    hand->wrist_path = std::move(planned.wrist_path);
    hands.push_back(*std::move(hand));
  }
  return hands;
}

Result<void> check_switch(flow::SwitchAction action, const std::vector<gloves::OpenHand>& hands) {
  const bool any = std::any_of(hands.begin(), hands.end(), [](const gloves::OpenHand& hand) {
    return hand.glove->info().abilities.wrist_switch;
  });
  if (any || action == flow::SwitchAction::none) return {};
  return Error{Errc::usage, "--switch " + std::string(name_of(action)) + ": " +
                                hands.front().glove->info().source +
                                (hands.size() > 1 ? " and the other glove have" : " has") +
                                " no wrist switch that nendo can read; leave --switch out"};
}

/// Warns about missing wrist switches. Other clutches are poses, which every glove can measure.
void note_missing_switches(const puppet::Puppet& puppet,
                           const std::vector<gloves::OpenHand>& hands) {
  for (const gloves::OpenHand& hand : hands) {
    const std::size_t slot = flow::Placement::index_of(hand.side);
    if (puppet.clutch.means[slot] != puppet::ClutchTrigger::wrist_switch ||
        hand.glove->info().abilities.wrist_switch)
      continue;
    cli::note("the puppet's [clutch] of the " + std::string(name_of(hand.side)) +
              " hand is the wrist switch, and " + hand.glove->info().source +
              " has none that nendo can read; that hand releases and grabs by the key " +
              (hand.side == Side::left ? "," : "'"));
  }
}

} // namespace

Result<RunHands> open_hands(RunOptions& options, const deform::Mesh& model,
                            EventCount& event_count) {
  if (options.loop.policy == flow::OverrunPolicy::sample) options.loop.event_count = &event_count;
  const bool named = !options.left.empty() || !options.right.empty();
  EventCount* const notified = options.loop.event_count;
  auto hands = !options.gloves.empty() ? open_each(options.gloves, notified)
               : named                 ? open_named(options, model, notified)
                                       : open_any(options, notified);
  if (!hands) return hands.error();
  if (!options.over) // whose gloves had the switch
    if (const auto fine = check_switch(options.loop.switch_action, *hands); !fine)
      return fine.error();
  if (options.puppet) note_missing_switches(*options.puppet, *hands);
  RunHands opened{*std::move(hands), {}};
  options.wrists.event_count = notified;
  if (const auto wrists = gloves::open_wrists(opened.hands, options.wrists); !wrists)
    return wrists.error();
  {
    const flow::InheritedPriority readers(flow::reader_priority(options.realtime.priority));
    if (readers.grant()) opened.grants.push_back(*readers.grant());
    if (const auto started = gloves::start(opened.hands); !started) return started.error();
  }
  if (const auto done = gloves::calibrate(opened.hands, options.calibration, options.length); !done)
    return done.error();
  return opened;
}

Result<void> check_count(const std::vector<std::string>& specs) {
  if (specs.size() <= 2) return {};
  return Error{Errc::usage, "GLOVE: takes 1 or 2 gloves, got " + std::to_string(specs.size())};
}

Result<std::vector<gloves::OpenHand>> open_each(const std::vector<std::string>& specs,
                                                EventCount* event_count) {
  std::vector<gloves::OpenHand> hands;
  for (const std::string& spec : specs) {
    auto hand = gloves::open_hand(spec, std::nullopt, event_count);
    if (!hand) return hand.error();
    hands.push_back(*std::move(hand));
  }
  if (hands.size() == 2 && hands[0].side == hands[1].side)
    return gloves::same_hand(hands[0], hands[1]);
  return hands;
}

} // namespace nendo::session
