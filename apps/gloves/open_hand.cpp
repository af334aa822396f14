#include "gloves/open_hand.hpp"

#include <algorithm>
#include <utility>

#include <nendo/base/advised_command.hpp>
#include <nendo/base/text.hpp>
#include <nendo/recording/replay_driver.hpp>

#include "cli/cli.hpp"

namespace nendo::gloves {
namespace {

void note_columns_not_read(const driver::GloveInfo& info) {
  for (const driver::DeviceFact& fact : info.facts)
    if (info.kind == driver::SourceKind::recorded && fact.name == "columns_not_read")
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

Result<void> open_wrists(std::span<OpenHand> hands, const WristOptions& options) {
  if (const auto fine = check(options); !fine) return fine;
  cli::install_stop_signals();
  const std::array more{recording::replay_tracker_driver()};
  auto opened = sculpting::open_wrists(hands, options, cli::note, more);
  if (cli::stop_requested())
    return Error{Errc::failed, "interrupted while a tracker was being identified"};
  return opened;
}

Error same_hand(const OpenHand& one, const OpenHand& other) {
  const driver::GloveInfo& info = other.glove->info();
  const std::string both = one.glove->info().source + " and " + info.source + " are both " +
                           std::string(name_of(other.side)) + "-hand gloves; ";
  if (info.kind == driver::SourceKind::recorded)
    return {Errc::usage, both + "a recording has one of each: leave one of them out"};
  const std::string wish = other.side == Side::left ? "hand=right" : "hand=left";
  std::string name = info.source;
  if (const std::size_t at = name.find("hand="); at != std::string::npos) {
    name.replace(at, name.find('&', at) - at, wish);
  } else {
    name = driver::with_option(name, wish);
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

void add_calibration_options(cli::Command& command, CalibrationOptions& options, bool two_gloves) {
  command.add_option("--user", options.user, "The wearer, whose stored calibration is used");
  if (two_gloves) {
    command.add_option("--left-user", options.left_user,
                       "The wearer of the left glove, if it is another one");
    command.add_option("--right-user", options.right_user, "The same for the right glove");
  }
  command.add_option("--calibration", options.calibration,
                     "A file or stored name to use instead (see nendo calibration), or none");
  command.add_flag("--adapt", options.adapt,
                   "Learn while the glove is used: the wearer's ranges, or, with the --user or the "
                   "--calibration of a hand that was calibrated by poses, how far the glove slips; "
                   "with --user, nendo run keeps what was learned, and continues from it");
}

void add_wrist_options(cli::Command& command, WristOptions& options) {
  command.add_option("--left-wrist", options.trackers[0], "TRACKER that moves the left hand");
  command.add_option("--right-wrist", options.trackers[1], "TRACKER that moves the right hand");
  command.add_option("--wrist-scale", options.movement_scale,
                     "Multiplies the movements of trackers on the stage, 0.05 to 20");
}

Result<void> check(const WristOptions& options) {
  constexpr double min_scale = 0.05, max_scale = 20.0;
  if (options.movement_scale >= min_scale && options.movement_scale <= max_scale) return {};
  return Error{Errc::usage, "--wrist-scale: use a number from 0.05 to 20"};
}

std::vector<driver::TrackerDriver> tracker_drivers() {
  const std::array more{recording::replay_tracker_driver()};
  return driver::tracker_drivers(more);
}

Result<void> check(const CalibrationOptions& options) {
  if (!options.adapt || options.calibration != "none") return {};
  return Error{Errc::usage, "--calibration none: --adapt begins without a calibration by itself; "
                            "leave out one of the two"};
}

Result<void> HandLength::check() const {
  constexpr double min_mm = 100.0;
  constexpr double max_mm = 250.0;
  if (!length_mm || (*length_mm >= min_mm && *length_mm <= max_mm)) return {};
  return Error{Errc::usage, "--hand-length: use 100 to 250 millimetres, from the wrist's crease to "
                            "the tip of the middle finger"};
}

hand::HandSize HandLength::size(const hand::HandSize& known) const noexcept {
  if (!length_mm) return known;
  const double length_m = 1e-3 * *length_mm;
  return {length_m, length_m / known.length_m * known.breadth_m, known.shape};
}

void add_hand_length(cli::Command& command, HandLength& length) {
  command.add_millimetres("--hand-length", length.length_mm,
                          "The wearer's hand in millimetres or as 18.5cm, from the wrist's crease "
                          "to the tip of the middle finger, 100 to 250; without it, as the "
                          "calibration says");
}

} // namespace nendo::gloves
