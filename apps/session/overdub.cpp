#include "session/overdub.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include <nendo/flow/sculptor.hpp>

#include "cli/cli.hpp"
#include "cli/quantities.hpp"
#include "session/run_options.hpp"

namespace nendo::session {
namespace {

using Span = Overdub::Span;

/// The time between making the loop and the run's begin, so that all threads are ready.
constexpr HostClock::duration count_in = std::chrono::milliseconds(300);

Error bad_span(const std::string& option, const std::string& text, const std::string& why) {
  return {Errc::usage, option + " " + text + ": " + why};
}

Result<Span> parse_span(const std::string& option, const std::string& text,
                        HostClock::duration length) {
  const auto span = cli::parse_time_span(text, option, cli::SpanEnds::may_be_open);
  if (!span) return span.error();
  const auto from = from_seconds(span->from_s);
  if (from >= length)
    return bad_span(option, text, fmt::format("the recording lasts {:.2f} s", to_seconds(length)));
  return Span{from, std::isinf(span->to_s) ? HostClock::duration::max() : from_seconds(span->to_s)};
}

Result<void> set_round(const std::string& text, flow::InputScript& script) {
  if (text.empty()) return {};
  const auto span = parse_span("--loop", text, script.length());
  if (!span) return span.error();
  const flow::InputScript::Round round{span->from, std::min(span->to, script.length())};
  if (round.to - round.from < flow::InputScript::shortest_round)
    return bad_span("--loop", text, "use 0.2 s at least");
  script.repeat(round);
  return {};
}

std::array<bool, 2> sides_without_layer(const RunOptions& options) {
  if (!options.left.empty() || !options.right.empty())
    return {!options.left.empty(), !options.right.empty()};
  const recording::Setup& take = options.over->take.setup;
  const std::array lacks{!has_hand(take, Side::left), !has_hand(take, Side::right)};
  return lacks[0] || lacks[1] ? lacks : std::array{true, true};
}

/// The named gloves must be those of the layer.
Result<void> check_gloves(const std::array<flow::AngleSet, 2>& part, const RunOptions& options) {
  if (options.left.empty() && options.right.empty()) return {};
  for (const Side side : {Side::left, Side::right}) {
    const bool plays = !part[flow::Placement::index_of(side)].is_empty();
    const bool is_named = !(side == Side::left ? options.left : options.right).empty();
    const std::string hand(name_of(side));
    if (plays && !is_named)
      return Error{Errc::usage,
                   "--layer: no glove plays the " + hand + " hand; give one with --" + hand};
    if (is_named && !plays)
      return Error{Errc::usage, "--" + hand + ": the layer does not contain that hand; add " +
                                    hand + " to --layer, or leave the glove out"};
  }
  return {};
}

/// Fades the layer in and out at the times of --punch, in each round.
void punch(const Span& span, std::uint8_t input, flow::InputScript& script) {
  const auto add = [&](HostClock::duration at, bool on) {
    script.add(at, flow::SetLayer{input, on});
  };
  if (const auto& round = script.round())
    add(round->from, span.from <= round->from && round->from < span.to);
  if (span.from > HostClock::duration::zero()) add(span.from, true);
  if (span.to <= script.length()) add(span.to, false);
}

} // namespace

void add_overdub_options(const cli::Command& whole, OverdubArguments& arguments) {
  cli::Command command = whole.under("Takes in layers");
  command.add_option(
      "--over", arguments.take,
      "A recording to replay while the gloves play over it; it decides model, puppet, places and "
      "settings");
  command.add_option(
      "--layer", arguments.layer,
      "The joints that the gloves play: left, right, or parts separated by commas, such as "
      "left.index,right.wrist (thumb, index, middle, ring, little, palm, wrist, or a joint's "
      "angle); without it, the hands that the recording lacks or, if it lacks none, all. Without "
      "--over, all other joints rest");
  command.add_option(
      "--punch", arguments.punch,
      "IN:OUT, times of the recording between which the gloves play, e.g. 2s:5.5s; key o does the "
      "same");
  command.add_option(
      "--loop", arguments.loop,
      "A:B, times of the recording: repeats this part until the run ends; : is the whole "
      "recording");
}

bool has_hand(const recording::Setup& take, Side side) {
  return std::any_of(take.hands.begin(), take.hands.end(),
                     [side](const flow::HandInput& hand) { return hand.side == side; });
}

Result<std::shared_ptr<Overdub>> read_overdub(const OverdubArguments& arguments) {
  if (arguments.take.empty()) {
    for (const auto& [option, value] :
         {std::pair{"--punch", &arguments.punch}, {"--loop", &arguments.loop}})
      if (!value->empty()) return Error{Errc::usage, std::string(option) + ": needs --over"};
    return std::shared_ptr<Overdub>();
  }
  auto take = recording::read_take_input(arguments.take);
  if (!take) return take.error();
  const auto over = std::make_shared<Overdub>(Overdub{arguments.take, *std::move(take)});
  flow::InputScript& script = *over->take.script;
  if (const auto fine = set_round(arguments.loop, script); !fine) return fine.error();
  if (!arguments.punch.empty()) {
    const auto span = parse_span("--punch", arguments.punch, script.length());
    if (!span) return span.error();
    over->punch = *span;
  }
  if (!over->take.is_exact)
    cli::note(arguments.take + ": something is missing in it, so the shape may differ");
  return over;
}

Result<LivePart> live_part(const OverdubArguments& arguments, const RunOptions& options) {
  if (arguments.layer.empty()) {
    if (!options.over) return LivePart();
    std::array<flow::AngleSet, 2> part{};
    const auto sides = sides_without_layer(options);
    for (std::size_t slot = 0; slot < part.size(); ++slot)
      if (sides[slot]) part[slot] = flow::AngleSet::all();
    return LivePart(part);
  }
  const auto part = flow::parse_layer(arguments.layer);
  if (!part)
    return Error{Errc::usage,
                 "--layer " + arguments.layer +
                     ": use left, right, or parts of them separated by commas, such as "
                     "left.index,right.wrist: thumb, index, middle, ring, little, palm, wrist, or "
                     "an angle like index_mcp_abduction"};
  if (const auto fine = check_gloves(*part, options); !fine) return fine.error();
  return LivePart(*part);
}

Result<void> take_over_settings(const deform::Mesh& model, RunOptions& options) {
  const recording::Setup& take = options.over->take.setup;
  auto loop = recording::loop_options_of(take, model);
  if (!loop) return Error{loop.error().code, options.over->file + ": " + loop.error().message};
  loop->spin = options.loop.spin;
  loop->sculptor.deformer.evaluation.threads = options.loop.sculptor.deformer.evaluation.threads;
  // The recorded samples have the times of a grid.
  if (loop->policy == flow::OverrunPolicy::sample) loop->policy = flow::OverrunPolicy::skip;
  loop->script = options.over->take.script.get();
  options.filter = loop->settings ? loop->settings->filter : take.hands.front().filter;
  if (flow::is_played(loop->rig.get())) options.puppet = loop->rig->puppet();
  options.loop = *std::move(loop);
  return {};
}

Result<void> play_over(const RunOptions& options, std::vector<flow::HandInput>& inputs) {
  Overdub& over = *options.over;
  flow::InputScript& script = *over.take.script;
  over.begin = HostClock::now() + count_in;
  script.begin_at(over.begin);
  std::vector<flow::HandInput> all = over.take.setup.hands;
  if (all.size() + inputs.size() > flow::max_inputs)
    return Error{
        Errc::usage,
        fmt::format("--over {}: has {} hands and layers, and the max of a run is {}; record "
                    "over an earlier take",
                    over.file, all.size(), flow::max_inputs)};
  for (flow::HandInput& hand : all)
    hand.first = script.moved(hand.first);
  for (flow::HandInput& live : inputs) {
    live.layer->on = over.begins_on();
    live.layer->weight = live.layer->on ? 1.0 : 0.0;
    if (over.punch) punch(*over.punch, static_cast<std::uint8_t>(all.size()), script);
    all.push_back(std::move(live));
  }
  inputs = std::move(all);
  return {};
}

} // namespace nendo::session
