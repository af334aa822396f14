#include "gloves/open_hand.hpp"

#include <algorithm>
#include <chrono>
#include <thread>
#include <utility>

#include <nendo/base/advised_command.hpp>
#include <nendo/base/text.hpp>
#include <nendo/recording/replay_driver.hpp>

#include "cli/cli.hpp"

namespace nendo::gloves {
namespace {

using std::chrono::milliseconds;

/// Of a table that is replayed.
void note_columns_not_read(const driver::GloveInfo& info) {
  for (const driver::GloveFact& fact : info.facts)
    if (info.kind == driver::GloveKind::recorded && fact.name == "columns_not_read")
      cli::note(printable(info.source) + ": not read: " + fact.value);
}

Result<void> wait_for_first_sample(OpenHand& hand) {
  const double rate_hz = hand.glove->info().rate_hz;
  // A glove whose rate is not known may send one record a second.
  const double patience_s = rate_hz > 0.0 ? std::clamp(3.0 / rate_hz, 2.0, 60.0) : 4.0;
  const auto patience = from_seconds(patience_s);
  const HostTime end = HostClock::now() + patience;
  while (HostClock::now() < end && !cli::stop_requested()) {
    if (hand.ring->try_pop(hand.first)) return {};
    std::this_thread::sleep_for(milliseconds(5));
  }
  if (cli::stop_requested()) return Error{Errc::failed, "stopped before the first sample came"};
  return Error{Errc::no_device, hand.glove->info().source + ": opened, but no sample came within " +
                                    std::to_string(static_cast<int>(patience_s)) +
                                    " s; is the glove plugged into its interface unit?"};
}

} // namespace

driver::GloveContext glove_context(motions::PlannedHand* planned) {
  return {{recording::replay_driver()}, motions::planned_motions(planned)};
}

Result<std::unique_ptr<driver::Glove>> open_glove(const std::string& spec, std::optional<Side> side,
                                                  motions::PlannedHand* planned) {
  cli::install_stop_signals();
  auto glove = driver::open_glove(spec, side, glove_context(planned));
  if (cli::stop_requested())
    return Error{Errc::failed, spec + ": interrupted while its glove was being identified"};
  if (glove) note_columns_not_read((*glove)->info());
  return glove;
}

Result<OpenHand> open_hand(const std::string& spec, std::optional<Side> side,
                           EventCount* event_count, motions::PlannedHand* planned) {
  auto glove = open_glove(spec, side, planned);
  if (!glove) return glove.error();
  return hand_of(*std::move(glove), side, event_count);
}

OpenHand hand_of(std::unique_ptr<driver::Glove> glove, std::optional<Side> side,
                 EventCount* event_count) {
  const Side own_side = glove->info().side;
  if (side && own_side != *side) {
    cli::note(glove->info().source + " says that it is a " + std::string(name_of(own_side)) +
              "-hand glove; it shapes as the " + std::string(name_of(*side)) +
              " hand, as you asked");
  }
  OpenHand hand;
  hand.side = side.value_or(own_side);
  hand.ring = std::make_unique<SampleRing>(1024, event_count);
  hand.glove = std::move(glove);
  return hand;
}

Error same_hand(const OpenHand& one, const OpenHand& other) {
  const driver::GloveInfo& info = other.glove->info();
  const std::string both = one.glove->info().source + " and " + info.source + " are both " +
                           std::string(name_of(other.side)) + "-hand gloves; ";
  if (info.kind == driver::GloveKind::recorded)
    return {Errc::usage, both + "a recording has one of each: leave one of them out"};
  const std::string wish = other.side == Side::left ? "hand=right" : "hand=left";
  std::string name = info.source;
  if (const std::size_t at = name.find("hand="); at != std::string::npos) {
    name.replace(at, name.find('&', at) - at, wish);
  } else {
    name += (name.find('?') == std::string::npos ? "?" : "&") + wish;
  }
  return {Errc::usage,
          both + "leave one out, or, if that one is on the other hand, say " + shell_word(name)};
}

Result<void> start(std::span<OpenHand> hands) {
  for (OpenHand& hand : hands) {
    if (auto started = hand.glove->start(*hand.ring); !started) return started;
  }
  return {};
}

Result<void> begin_again(std::span<OpenHand> hands) {
  const auto is_worn = [](const OpenHand& hand) {
    return hand.glove->info().kind == driver::GloveKind::device;
  };
  for (OpenHand& hand : hands)
    if (!is_worn(hand)) hand.glove->stop();
  for (OpenHand& hand : hands) {
    if (is_worn(hand)) continue;
    hand.ring->drain([](const GloveSample&) noexcept {});
    if (auto started = hand.glove->start(*hand.ring); !started) return started;
  }
  return {};
}

bool have_ended(std::span<const OpenHand> hands) noexcept {
  return std::all_of(hands.begin(), hands.end(),
                     [](const OpenHand& hand) { return hand.glove->has_ended(); });
}

namespace {

/// A wearer was named for a hand that no glove has.
Result<void> check_users(std::span<const OpenHand> hands, const CalibrationOptions& options) {
  for (const Side side : {Side::left, Side::right}) {
    const std::string& user = side == Side::left ? options.left_user : options.right_user;
    const bool is_worn = std::any_of(hands.begin(), hands.end(), [side](const OpenHand& hand) {
      return hand.first.side == side;
    });
    if (!user.empty() && !is_worn)
      return Error{Errc::usage, "--" + std::string(name_of(side)) + "-user " + printable(user) +
                                    ": no glove here is of a " + std::string(name_of(side)) +
                                    " hand; leave it out"};
  }
  return {};
}

} // namespace

Result<void> calibrate(std::span<OpenHand> hands, const CalibrationOptions& options,
                       const HandLength& length) {
  for (OpenHand& hand : hands)
    if (auto came = wait_for_first_sample(hand); !came) return came;
  if (auto fine = check_users(hands, options); !fine) return fine;
  for (OpenHand& hand : hands) {
    // A sample tells the side of the glove that sent it, which need not be the identified one.
    auto wearer = find_wearer(hand.glove->info(), hand.first.side, options);
    if (!wearer) return wearer.error();
    hand.wearer = *std::move(wearer);
    hand.uncalibrated = is_uncalibrated(hand.glove->info(), hand.wearer, hand.first.side);
    for (hand::HandSize* size : {&hand.wearer.left.size, &hand.wearer.right.size})
      *size = length.size(*size);
  }
  return {};
}

} // namespace nendo::gloves
