// nendo edit show: the keys of a timeline, as a table or as JSON.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <iostream>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include <nendo/base/text.hpp>
#include <nendo/flow/setting.hpp>

#include "cli/cli.hpp"
#include "cli/figures.hpp"
#include "edit/edit_actions.hpp"
#include "timeline/hand_curve.hpp"
#include "timeline/timeline.hpp"

namespace nendo::edit {
namespace {

using timeline::HandTrack;
using timeline::Key;
using timeline::Timeline;

Eigen::Matrix<double, 3, 5> tips_of(const Timeline& timeline, const HandTrack& hand,
                                    const Key& key) {
  return timeline.units_per_metre *
         hand.skeleton().pose(key.angles, key.wrist_pose()).fingertip_positions();
}

nlohmann::ordered_json place_json(const Eigen::Vector3d& place) {
  return {place.x(), place.y(), place.z()};
}

nlohmann::ordered_json key_json(const Timeline& timeline, const HandTrack& hand, const Key& key) {
  nlohmann::ordered_json line{{"time_s", key.time_s}, {"wrist_m", place_json(key.wrist_m)}};
  const auto& turn = key.wrist_turn;
  line["wrist_turn"] = {turn.w(), turn.x(), turn.y(), turn.z()};
  for (std::size_t at = 0; at < hand::angle_count; ++at)
    line["angles_rad"][std::string(hand::angle_names[at])] = key.angles[hand::angle_at(at)];
  const auto tips = tips_of(timeline, hand, key);
  for (std::size_t at = 0; at < hand::finger_count; ++at)
    line["tips"][std::string(name_of(static_cast<hand::Finger>(at)))] =
        place_json(tips.col(static_cast<Eigen::Index>(at)));
  return line;
}

nlohmann::ordered_json settings_json(const flow::LoopSettings& settings) {
  nlohmann::ordered_json values;
  flow::for_each_shape_setting([&](const auto& setting) {
    values[std::string(setting.name)] = flow::reported_value(setting, settings);
  });
  return values;
}

nlohmann::ordered_json event_json(const Timeline& timeline, const timeline::Event& event) {
  nlohmann::ordered_json line{{"time_s", event.time_s}};
  if (const auto* change = std::get_if<flow::ChangeSettings>(&event.command))
    line["settings"] = settings_json(change->settings);
  else if (const auto* clutch = std::get_if<flow::SetClutch>(&event.command))
    line["clutch"] = {{"hand", name_of(clutch->side)},
                      {"finger", timeline::clutched_name(clutch->finger)},
                      {"holds", clutch->holds}};
  else if (const auto* role = std::get_if<flow::SetRole>(&event.command))
    line["role"] = {{"function", timeline.rig->puppet().functions[role->function].name},
                    {"input", role->input.name()}};
  else if (const auto* symmetry = std::get_if<flow::SetSymmetry>(&event.command))
    line["symmetric"] = symmetry->on;
  else if (std::holds_alternative<flow::ChangePuppet>(event.command))
    line["masks"] = in_words(timeline, event);
  else
    line["request"] = in_words(timeline, event);
  return line;
}

/// Which keys are at a time.
struct KeyTime {
  double time_s = 0.0;
  std::string keys; ///< "left 3, right 5"
};

std::vector<KeyTime> key_times(const Timeline& timeline) {
  std::vector<KeyTime> times;
  for (const HandTrack& hand : timeline.hands)
    for (std::size_t at = 0; at < hand.keys.size(); ++at)
      times.push_back(
          {hand.keys[at].time_s, std::string(name_of(hand.side)) + " " + std::to_string(at)});
  std::ranges::stable_sort(times, {}, &KeyTime::time_s);
  std::vector<KeyTime> merged;
  for (KeyTime& time : times) {
    if (merged.empty() || merged.back().time_s != time.time_s)
      merged.push_back(std::move(time));
    else
      merged.back().keys += ", " + time.keys;
  }
  return merged;
}

using ValuesAtKeys = std::function<void(const KeyTime& time, std::span<const double> values)>;

void for_each_key_time(const Timeline& timeline, const ValuesAtKeys& see) {
  const std::vector<KeyTime> keys = key_times(timeline);
  std::vector<double> times_s(keys.size());
  std::ranges::transform(keys, times_s.begin(), &KeyTime::time_s);
  timeline::play_functions(timeline, times_s,
                           [&](std::size_t at, const timeline::PuppetMoment& moment) {
                             see(keys[at], moment.hands.player().values());
                           });
}

/// The greatest first, so that a person finds the smile. What a hand that rests does is left out.
std::string values_text(const puppet::Puppet& puppet, std::span<const double> values) {
  constexpr double least = 0.1;
  std::vector<std::size_t> order;
  for (std::size_t at = 0; at < values.size(); ++at)
    if (std::abs(values[at]) > least) order.push_back(at);
  std::ranges::stable_sort(order, std::greater<>(),
                           [&](std::size_t at) { return std::abs(values[at]); });
  std::string text;
  for (const std::size_t at : order)
    text +=
        (text.empty() ? "" : ", ") + puppet.functions[at].name + " " + cli::fixed(values[at], 2);
  return text.empty() ? "at rest" : text;
}

void print_functions(const Timeline& timeline) {
  const puppet::Puppet& puppet = timeline.rig->puppet();
  std::printf("%9s  %-20s values of the functions, of those above 0.1\n", "time s", "keys");
  for_each_key_time(timeline, [&](const KeyTime& time, std::span<const double> values) {
    std::printf("%9.3f  %-20s %s\n", time.time_s, time.keys.c_str(),
                values_text(puppet, values).c_str());
  });
}

nlohmann::ordered_json functions_json(const Timeline& timeline) {
  auto all = nlohmann::ordered_json::array();
  for_each_key_time(timeline, [&](const KeyTime& time, std::span<const double> values) {
    nlohmann::ordered_json line{{"time_s", time.time_s}};
    for (std::size_t at = 0; at < values.size(); ++at)
      line["values"][timeline.rig->puppet().functions[at].name] = values[at];
    all.push_back(std::move(line));
  });
  return all;
}

void print_json(const ShowOptions& options, const Timeline& timeline) {
  nlohmann::ordered_json all{
      {"file", options.file},        {"take", timeline.take},
      {"mesh", timeline.mesh},       {"mode", flow::name_of(timeline.sculptor.mode)},
      {"rate_hz", timeline.rate_hz}, {"duration_s", timeline.duration_s},
      {"held", timeline.held}};
  all["events"] = nlohmann::ordered_json::array();
  for (const auto& event : timeline.events)
    all["events"].push_back(event_json(timeline, event));
  for (const HandTrack& hand : timeline.hands) {
    auto keys = nlohmann::ordered_json::array();
    for (const Key& key : hand.keys)
      keys.push_back(key_json(timeline, hand, key));
    all["hands"][std::string(name_of(hand.side))] = std::move(keys);
  }
  if (options.functions) all["functions"] = functions_json(timeline);
  std::cout << all.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace)
            << std::endl;
}

void print_hand(const Timeline& timeline, const HandTrack& hand,
                std::optional<hand::Finger> shown) {
  std::printf("%s hand: how far the fingers are bent, degrees%s\n",
              std::string(name_of(hand.side)).c_str(),
              shown ? "; a tip's place in the model's units" : "");
  std::printf("%6s %9s", "key", "time s");
  for (std::size_t at = 0; at < hand::finger_count; ++at)
    std::printf(" %6s", std::string(name_of(static_cast<hand::Finger>(at))).c_str());
  std::printf(shown ? "   %s tip\n" : "\n", shown ? std::string(name_of(*shown)).c_str() : "");
  for (std::size_t number = 0; number < hand.keys.size(); ++number) {
    const Key& key = hand.keys[number];
    std::printf("%6zu %9.3f", number, key.time_s);
    for (std::size_t at = 0; at < hand::finger_count; ++at)
      std::printf(" %6.0f", to_degrees(key.angles.flexion_rad(static_cast<hand::Finger>(at))));
    if (shown) {
      const Eigen::Vector3d tip =
          tips_of(timeline, hand, key).col(static_cast<Eigen::Index>(*shown));
      std::printf("   %.6g,%.6g,%.6g", tip.x(), tip.y(), tip.z());
    }
    std::printf("\n");
  }
}

} // namespace

int show_timeline(const ShowOptions& options) {
  std::optional<hand::Finger> finger;
  if (!options.finger.empty()) {
    const auto parsed = parse_finger(options.finger);
    if (!parsed) return cli::report(parsed.error());
    finger = *parsed;
  }
  const auto timeline = timeline::read_timeline(options.file);
  if (!timeline) return cli::report(timeline.error());
  if (options.functions && !timeline->rig)
    return cli::report({Errc::usage, options.file + ": --functions: there is no puppet in it"});
  if (options.json) {
    print_json(options, *timeline);
    return 0;
  }
  std::printf("%s: %.3f s at %g Hz, %s, of %s over %s\n", printable(options.file).c_str(),
              timeline->duration_s, timeline->rate_hz,
              std::string(flow::name_of(timeline->sculptor.mode)).c_str(),
              printable(timeline->take).c_str(), printable(timeline->mesh).c_str());
  if (options.functions)
    print_functions(*timeline);
  else
    for (const HandTrack& hand : timeline->hands)
      print_hand(*timeline, hand, finger);
  for (const auto& event : timeline->events)
    std::printf("at %9.3f s: %s\n", event.time_s, in_words(*timeline, event).c_str());
  std::fflush(stdout);
  return 0;
}

} // namespace nendo::edit
