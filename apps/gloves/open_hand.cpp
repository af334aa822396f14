#include "gloves/open_hand.hpp"

#include <algorithm>
#include <utility>

#include <nendo/base/advised_command.hpp>
#include <nendo/base/text.hpp>
#include <nendo/recording/replay_driver.hpp>

#include "cli/cli.hpp"

namespace nendo::gloves {
namespace {

/// Notes the unused columns of a replayed table.
void note_columns_not_read(const driver::GloveInfo& info) {
  for (const driver::GloveFact& fact : info.facts)
    if (info.kind == driver::GloveKind::recorded && fact.name == "columns_not_read")
      cli::note(printable(info.source) + ": not read: " + fact.value);
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
  return sculpting::hand_of(*std::move(glove), side, event_count, cli::note);
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
  if (auto came = sculpting::wait_for_samples(hands, cli::stop_requested); !came) return came;
  if (auto fine = check_users(hands, options); !fine) return fine;
  if (auto found = sculpting::find_wearers(hands, options, cli::note); !found) return found;
  for (OpenHand& hand : hands) {
    for (hand::HandSize* size : {&hand.wearer.left.size, &hand.wearer.right.size})
      *size = length.size(*size);
  }
  return {};
}

} // namespace nendo::gloves
