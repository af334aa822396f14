#include "gloves/glove_calibration.hpp"

#include <algorithm>

#include "cli/cli.hpp"
#include "cli/printable.hpp"
#include "gloves/calibration_names.hpp"
#include "gloves/recorded_hands.hpp"

namespace nendo::gloves {
namespace {

void tell(const driver::GloveInfo& glove, const hand::StoredCalibration& file,
          const std::string& doubt) {
  cli::note(cli::printable(glove.source) + ": calibrated for " + title_of(file.wearer) + " (" +
            cli::printable(file.path.string()) + ")" + doubt);
}

KnownHand hand_of(const hand::WearerCalibration& wearer, CountScale counts) {
  return {hand::calibration_for(wearer, counts), wearer.size};
}

KnownHand average_hand(CountScale counts) {
  return {hand::default_calibration(counts), {}};
}

Result<KnownHand> asked_for(const driver::GloveInfo& glove, Side side, const std::string& name) {
  const auto file = named_calibration(name);
  if (!file) return file.error();
  const auto refused = [&](const std::string& why) {
    return Error{Errc::bad_input, cli::printable(file->path.string()) + ": " + why +
                                      "; choose another, or --calibration none"};
  };
  if (file->wearer.side != side)
    return refused("is of a " + std::string(name_of(file->wearer.side)) + " hand, but " +
                   cli::printable(glove.source) + " is a " + std::string(name_of(side)) +
                   "-hand glove");
  if (file->wearer.counts.whole_range != glove.counts.whole_range)
    return refused("is of another kind of glove than " + cli::printable(glove.source));
  tell(glove, *file, "");
  return hand_of(file->wearer, glove.counts);
}

/// The best that is stored for either side.
Result<KnownHands> stored_hands(const driver::GloveInfo& glove, KnownHands hands,
                                const std::string& user) {
  const auto stored = stored_calibrations();
  const auto choose = [&](Side side, const std::string& serial) {
    return hand::choose_calibration(stored.files, {user, glove.model, serial, side, glove.counts});
  };
  const auto own = choose(hands.side, serial_of(glove));
  if (own) {
    tell(glove, *own->file,
         own->match == hand::GloveMatch::other_glove ? "; made with another glove of this model"
                                                     : "");
    hands.own = hand_of(own->file->wearer, glove.counts);
  } else if (!user.empty()) {
    return Error{Errc::bad_input, "--user " + cli::printable(user) + ": no calibration of a " +
                                      std::string(name_of(hands.side)) + " hand for " +
                                      cli::printable(glove.source) +
                                      " is stored; `nendo calibration list` shows what is"};
  }
  const Side other = hands.side == Side::left ? Side::right : Side::left;
  if (glove.source.starts_with("sim")) return hands; // its hand does not change
  const auto swapped = choose(other, "");            // of an unknown number
  if (swapped) hands.swapped = hand_of(swapped->file->wearer, glove.counts);
  return hands;
}

} // namespace

std::string serial_of(const driver::GloveInfo& glove) {
  const auto fact = std::find_if(glove.facts.begin(), glove.facts.end(),
                                 [](const auto& known) { return known.name == "serial"; });
  return fact == glove.facts.end() ? "" : fact->value;
}

void add_calibration_options(cli::Command& command, CalibrationOptions& options) {
  command.add_option("--user", options.user, "The wearer, whose stored calibration is used");
  command.add_option("--calibration", options.calibration,
                     "A file or stored name to use instead (see nendo calibration), or none");
  command.add_flag("--adapt", options.adapt,
                   "Learn the wearer's ranges while the glove is used, in place of a calibration");
}

Result<void> check(const CalibrationOptions& options) {
  if (!options.adapt || (options.user.empty() && options.calibration.empty())) return {};
  return Error{Errc::usage, "--adapt learns the hand from how it moves; leave out " +
                                std::string(options.user.empty() ? "--calibration" : "--user")};
}

Result<KnownHands> known_hands(const driver::GloveInfo& glove, Side side,
                               const CalibrationOptions& options) {
  KnownHands hands{side, average_hand(glove.counts), average_hand(glove.counts), {}};
  if (options.adapt) {
    hands.adapt = glove.counts;
    return hands;
  }
  if (options.calibration == "none") return hands;
  if (!options.calibration.empty()) {
    const auto own = asked_for(glove, side, options.calibration);
    if (!own) return own.error();
    hands.own = *own;
    return hands;
  }
  // The simulated wearer has the hand that the default is for.
  if (options.user.empty() && glove.source.starts_with("sim")) return hands;
  if (options.user.empty()) {
    if (const auto recorded = recorded_hand(glove, side)) {
      hands.own = {recorded->calibration, recorded->size};
      hands.swapped = {recorded->swapped, recorded->swapped_size};
      return hands;
    }
  }
  return stored_hands(glove, hands, options.user);
}

} // namespace nendo::gloves
