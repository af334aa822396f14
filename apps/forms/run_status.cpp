#include "forms/run_status.hpp"

#include <cstdio>

#include <nendo/base/figures.hpp>

namespace nendo::forms {
namespace {

std::string in_figures(double number, int decimals) {
  char text[48];
  std::snprintf(text, sizeof text, "%.*f", decimals, number);
  return text;
}

/// A silent glove and a lost tracker, or how old the newest sample is.
std::string state_of(const flow::HandFrame& hand, HostTime woke) {
  if (hand.silent) return "silent";
  if (hand.lost) return "tracker lost";
  return in_figures(1e3 * to_seconds(woke - hand.newest_sample), 0) + " ms";
}

std::string counted(std::uint64_t number) {
  return thousands(static_cast<std::int64_t>(number));
}

} // namespace

std::vector<StatusItem> status_items(const flow::Frame& frame, double rate_hz,
                                     std::size_t vertices) {
  std::vector<StatusItem> all{
      {frame.held ? "holds the model" : "holds nothing",
       "Whether the hands hold the model: g grabs it, l releases it."},
      {counted(vertices) + " vertices", "Of the model; e makes them about four times as many."}};
  if (frame.clay.is_clay && frame.clay.first_volume > 0.0)
    all.push_back({volume_text(frame, frame.clay.volume), "The volume of the clay."});
  all.push_back({in_figures(rate_hz, 0) + " Hz, " + counted(frame.missed) + " of " +
                     counted(frame.ticks_run) + " missed",
                 "The rate of the loop, and how many of its ticks missed their deadlines."});
  for (const Side side : {Side::left, Side::right}) {
    const flow::HandFrame& hand = frame.hands[flow::Placement::index_of(side)];
    if (hand.present)
      all.push_back({std::string(name_of(side)) + " " + state_of(hand, frame.woke),
                     "How old the newest sample of this hand is, or that its glove is silent."});
  }
  return all;
}

std::string volume_text(const flow::Frame& frame, double volume) {
  const double units = frame.units_per_metre;
  return in_figures(1e6 * volume / (units * units * units), 1) + " cm3";
}

} // namespace nendo::forms
