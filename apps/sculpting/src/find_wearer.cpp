#include <nendo/sculpting/find_wearer.hpp>

#include <algorithm>
#include <bit>
#include <set>
#include <utility>
#include <vector>

#include <nendo/base/advised_command.hpp>
#include <nendo/base/endings.hpp>
#include <nendo/base/text.hpp>
#include <nendo/recording/take_reader.hpp>
#include <nendo/sculpting/kept_learning.hpp>

namespace nendo::sculpting {
namespace {

void report_choice(const driver::GloveInfo& glove, const hand::StoredCalibration& file,
                   const std::string& doubt, const Note& note) {
  note(printable(glove.source) + ": calibrated for " + title_of(file.wearer) + " (" +
       printable(file.path.string()) + ")" + doubt);
  if (file.wearer.left_out.bits != 0)
    note(printable(glove.source) + ": " + sensors_in_words(file.wearer.left_out) +
         (is_one(file.wearer.left_out) ? " was" : " were") +
         " stuck when it was calibrated, so estimated from the sensors beside; once the glove "
         "is repaired, calibrate it again");
}

/// `user` has calibrations, but none for this glove and hand; empty: any wearer.
void report_none(const driver::GloveInfo& glove, Side side, const std::string& user,
                 const Note& note) {
  const std::string source = printable(glove.source), name = printable(user);
  const std::string hand(name_of(side));
  const std::string lacks =
      user.empty() ? "not calibrated for this " + hand + " hand"
                   : name + " has no calibration of a " + hand + " hand for this glove";
  note(source + ": " + lacks + ", so angles are an average hand's; `nendo calibrate " +
       shell_word(source) + " --user " +
       (user.empty() ? "NAME` makes them the wearer's" : shell_word(name) + "` makes one"));
}

/// Fails if nothing at all is stored for the user, and names the users that there are.
Result<void> check_user(const hand::CalibrationList& stored, const std::string& option,
                        const std::string& user) {
  std::set<std::string> users;
  for (const hand::StoredCalibration& file : stored.files)
    users.insert(file.wearer.user);
  if (users.contains(user)) return {};
  std::string known;
  for (const std::string& one : users)
    known.append(known.empty() ? "" : ", ").append(printable(one));
  return Error{
      Errc::bad_input,
      option + " " + printable(user) + ": no calibration of " + printable(user) + " is stored; " +
          (known.empty() ? "no user has one yet" : "there are those of " + known) +
          "; `nendo calibrate GLOVE --user " + shell_word(printable(user)) + "` makes one"};
}

/// Warns about the calibration that a glove of the other hand would get in place of `glove`, if it
/// is another wearer's.
void report_other(const driver::GloveInfo& glove, const hand::StoredCalibration& own,
                  const hand::StoredCalibration& other, const Note& note) {
  if (own.wearer.user == other.wearer.user) return;
  note(printable(glove.source) + ": a " + std::string(name_of(other.wearer.side)) +
       "-hand glove in its place would be calibrated for " + title_of(other.wearer) + " (" +
       printable(other.path.string()) + ")");
}

/// Returns a note about a choice that may be meant for another glove. A
/// CyberGlove has no serial number, so that its calibrations are for any glove.
std::string doubt_about(const hand::CalibrationChoice& choice) {
  if (choice.match == hand::GloveMatch::this_glove) return "";
  if (choice.match == hand::GloveMatch::other_glove)
    return "; made with another glove of this model";
  return choice.file->wearer.glove_model.empty()
             ? "; it does not name the glove with which it was made"
             : "; made with a glove of this model, maybe another one";
}

hand::WearerHand hand_of(const hand::WearerCalibration& wearer, CountScale counts) {
  return {hand::calibration_for(wearer, counts), wearer.size, wearer.left_out};
}

Result<hand::StoredCalibration> asked_for(const driver::GloveInfo& glove, Side side,
                                          const std::string& name, const Note& note) {
  auto file = named_calibration(name, note);
  if (!file) return file.error();
  const auto refused = [&](const std::string& why) {
    return Error{Errc::bad_input, printable(file->path.string()) + ": " + why +
                                      "; choose another, or --calibration none"};
  };
  if (file->wearer.side != side)
    return refused("is of a " + std::string(name_of(file->wearer.side)) + " hand, but " +
                   printable(glove.source) + " is a " + std::string(name_of(side)) + "-hand glove");
  if (file->wearer.counts.self_calibrated != glove.counts.self_calibrated)
    return refused("is of another kind of glove than " + printable(glove.source));
  report_choice(glove, *file, "", note);
  return file;
}

/// Returns the calibrations and sizes with which the hand of that side was recorded, if `glove`
/// replays a recording that has such a hand. What adaptation had learned is left out.
std::optional<hand::Wearer> recorded_wearer(const driver::GloveInfo& glove, Side side) {
  if (glove.kind != driver::SourceKind::recorded) return std::nullopt;
  const auto reader = recording::TakeReader::open(glove.recording);
  if (!reader) return std::nullopt;
  for (const auto& hand : reader->setup().hands) {
    if (hand.first.side == side) return hand::Wearer{hand.wearer.left, hand.wearer.right};
  }
  return std::nullopt;
}

/// Gives the wearer the best calibration that is stored for a glove of the other hand, which may be
/// plugged in later, so that its serial number is not known. Returns it, if there is one.
std::optional<hand::CalibrationChoice> set_other(const driver::GloveInfo& glove, Side side,
                                                 const std::string& user,
                                                 const hand::CalibrationList& stored,
                                                 hand::Wearer& wearer) {
  const Side other = opposite(side);
  const auto choice =
      hand::choose_calibration(stored.files, {user, glove.model, "", other, glove.counts});
  if (choice) wearer.of(other) = hand_of(choice->file->wearer, glove.counts);
  return choice;
}

FoundCalibration found_in(const hand::StoredCalibration& file) {
  return {FoundCalibration::Kind::stored, file.wearer.user, file.path};
}

Result<hand::Wearer> stored_wearer(const driver::GloveInfo& glove, Side side, hand::Wearer wearer,
                                   const CalibrationOptions& options, const Note& note,
                                   FoundCalibration& found) {
  const std::string& user = options.user_of(side);
  const auto stored = stored_calibrations(note);
  const auto own = best_calibration(stored, glove, side, user);
  if (own) {
    report_choice(glove, *own->file, doubt_about(*own), note);
    wearer.of(side) = hand_of(own->file->wearer, glove.counts);
    found = found_in(*own->file);
  } else if (!user.empty()) {
    const std::string& own_user = side == Side::left ? options.left_user : options.right_user;
    const std::string option =
        own_user.empty() ? "--user" : "--" + std::string(name_of(side)) + "-user";
    if (auto known = check_user(stored, option, user); !known) return known.error();
    report_none(glove, side, user, note);
  } else if (is_uncalibrated(glove, wearer, side)) {
    report_none(glove, side, user, note);
  }
  if (glove.kind == driver::SourceKind::simulated) return wearer; // its hand does not change
  const auto other = set_other(glove, side, options.user_of(opposite(side)), stored, wearer);
  const bool is_named = !options.user_of(opposite(side)).empty(); // then it is no surprise
  if (own && other && !is_named) report_other(glove, *own->file, *other->file, note);
  return wearer;
}

/// Of a hand that was calibrated by poses, slips are learned; of others, ranges.
Result<hand::Wearer> adapting_wearer(const driver::GloveInfo& glove, Side side, hand::Wearer wearer,
                                     const CalibrationOptions& options, const Note& note,
                                     FoundCalibration& found) {
  const std::string& user = options.user_of(side);
  wearer.adapt = glove.counts;
  std::optional<hand::StoredCalibration> made;
  if (!options.calibration.empty()) {
    const auto file = asked_for(glove, side, options.calibration, note);
    if (!file) return file.error();
    made = *file;
  } else if (!user.empty()) {
    const auto stored = stored_calibrations(note);
    const auto choice = best_calibration(stored, glove, side, user);
    if (choice && !is_kept_ranges(choice->file->wearer)) {
      made = *choice->file;
      report_choice(glove, *made, doubt_about(*choice), note);
      set_other(glove, side, options.user_of(opposite(side)), stored, wearer);
    }
  }
  if (made) {
    const auto ends = ends_of(*made, glove);
    if (!ends) return ends.error();
    wearer.ends = *ends;
    wearer.of(side) = hand_of(made->wearer, glove.counts);
    found = found_in(*made);
    return wearer;
  }
  const auto learned = kept_ranges(glove, side, user);
  if (!learned) return learned.error();
  wearer.learned = *learned;
  found = {FoundCalibration::Kind::learned, user, {}};
  return wearer;
}

using hand::StoredCalibration;

std::string stem_of(const StoredCalibration& file) {
  return file.path.stem().string();
}

} // namespace

std::string serial_of(const driver::GloveInfo& glove) {
  const auto fact = std::find_if(glove.facts.begin(), glove.facts.end(),
                                 [](const auto& known) { return known.name == "serial"; });
  return fact == glove.facts.end() ? "" : fact->value;
}

std::optional<hand::CalibrationChoice> best_calibration(const hand::CalibrationList& stored,
                                                        const driver::GloveInfo& glove, Side side,
                                                        const std::string& user) {
  return hand::choose_calibration(stored.files,
                                  {user, glove.model, serial_of(glove), side, glove.counts});
}

const std::string& CalibrationOptions::user_of(Side side) const noexcept {
  const std::string& own = side == Side::left ? left_user : right_user;
  return own.empty() ? user : own;
}

std::string CalibrationOptions::users() const {
  const std::string& left = user_of(Side::left);
  const std::string& right = user_of(Side::right);
  if (left == right) return left;
  if (left.empty()) return right;
  if (right.empty()) return left;
  return "left " + left + ", right " + right;
}

namespace {

Result<hand::Wearer> chosen_wearer(const driver::GloveInfo& glove, Side side,
                                   const CalibrationOptions& options, const Note& note,
                                   FoundCalibration& result) {
  const hand::WearerHand average{hand::default_calibration(glove.counts), {}};
  hand::Wearer wearer{average, average};
  if (options.adapt) return adapting_wearer(glove, side, wearer, options, note, result);
  if (options.calibration == "none") return wearer;
  if (!options.calibration.empty()) {
    const auto own = asked_for(glove, side, options.calibration, note);
    if (!own) return own.error();
    wearer.of(side) = hand_of(own->wearer, glove.counts);
    result = found_in(*own);
    return wearer;
  }
  const bool is_anybody = options.user_of(side).empty();
  // The simulated wearer has the hand that the default is for.
  if (is_anybody && glove.kind == driver::SourceKind::simulated) return wearer;
  if (is_anybody) {
    if (const auto recorded = recorded_wearer(glove, side)) {
      result.kind = FoundCalibration::Kind::recorded;
      return *recorded;
    }
  }
  return stored_wearer(glove, side, wearer, options, note, result);
}

} // namespace

Result<hand::Wearer> find_wearer(const driver::GloveInfo& glove, Side side,
                                 const CalibrationOptions& options, const Note& note,
                                 FoundCalibration* found) {
  FoundCalibration unwanted;
  auto wearer = chosen_wearer(glove, side, options, note, found == nullptr ? unwanted : *found);
  if (wearer) wearer->watched = glove.counts;
  return wearer;
}

bool is_uncalibrated(const driver::GloveInfo& glove, const hand::Wearer& wearer, Side side) {
  return glove.kind == driver::SourceKind::device && !wearer.adapt &&
         wearer.of(side).calibration == hand::default_calibration(glove.counts);
}

hand::CalibrationList stored_calibrations(const Note& note) {
  auto list = hand::list_calibrations(hand::calibration_folders());
  for (const auto& error : list.unreadable)
    note(printable(error.message));
  return list;
}

Result<StoredCalibration> named_calibration(const std::string& name, const Note& note) {
  if (name.find('/') != std::string::npos || ends_in(name, ".toml")) {
    auto wearer = hand::read_calibration(name);
    if (!wearer) return wearer.error();
    return StoredCalibration{name, false, *std::move(wearer)};
  }
  const auto list = stored_calibrations(note);
  std::vector<const StoredCalibration*> meant;
  for (const auto& file : list.files) {
    if (stem_of(file) == name) return file; // the user's own comes first
    if (file.wearer.user == name && is_active_calibration(file, list.files)) meant.push_back(&file);
  }
  if (meant.size() == 1) return *meant.front();
  if (meant.empty()) {
    return Error{Errc::bad_input, printable(name) + ": no such calibration is stored; "
                                                    "`nendo calibration list` shows them"};
  }
  std::string several;
  for (const auto* file : meant)
    several.append(several.empty() ? "" : " or ").append(stem_of(*file));
  return Error{Errc::usage, printable(name + ": several are meant; name " + several)};
}

std::string title_of(const hand::WearerCalibration& wearer) {
  return printable(wearer.user + ", " + std::string(name_of(wearer.side)) + " hand, " +
                   (wearer.glove_serial.empty() ? "any glove" : "glove " + wearer.glove_serial));
}

bool is_one(SensorMask sensors) noexcept {
  return std::popcount(sensors.bits) == 1;
}

std::string sensors_in_words(SensorMask sensors) {
  std::string text;
  int left = std::popcount(sensors.bits);
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    if (!sensors.has(static_cast<Sensor>(slot))) continue;
    text.append(name_of(static_cast<Sensor>(slot)));
    --left;
    if (left > 0) text += left == 1 ? " and " : ", ";
  }
  return text;
}

} // namespace nendo::sculpting
