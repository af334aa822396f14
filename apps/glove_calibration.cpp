#include "glove_calibration.hpp"

#include <algorithm>

#include "calibration_names.hpp"
#include "cli.hpp"
#include "printable.hpp"

namespace nendo::app {
namespace {

void tell(const driver::GloveInfo& glove, const hand::StoredCalibration& file,
          const std::string& doubt) {
  note(printable(glove.source) + ": calibrated for " + title_of(file.wearer) + " (" +
       printable(file.path.string()) + ")" + doubt);
}

Result<hand::Calibration> asked_for(const driver::GloveInfo& glove, Side side,
                                    const std::string& name) {
  const auto file = named_calibration(name);
  if (!file) return file.error();
  const auto refused = [&](const std::string& why) {
    return Error{Errc::bad_input, printable(file->path.string()) + ": " + why +
                                      "; choose another, or --calibration none"};
  };
  if (file->wearer.side != side)
    return refused("is of a " + std::string(name_of(file->wearer.side)) + " hand, but " +
                   printable(glove.source) + " is a " + std::string(name_of(side)) + "-hand glove");
  if (file->wearer.counts.whole_range != glove.counts.whole_range)
    return refused("is of another kind of glove than " + printable(glove.source));
  tell(glove, *file, "");
  return hand::calibration_for(file->wearer, glove.counts);
}

} // namespace

std::string serial_of(const driver::GloveInfo& glove) {
  const auto fact = std::find_if(glove.facts.begin(), glove.facts.end(),
                                 [](const auto& known) { return known.name == "serial"; });
  return fact == glove.facts.end() ? "" : fact->value;
}

void add_calibration_options(Command& command, CalibrationOptions& options) {
  command.add_option("--user", options.user, "The wearer, whose stored calibration is used");
  command.add_option("--calibration", options.calibration,
                     "A file or stored name to use instead (see nendo calibration), or none");
}

Result<hand::Calibration> calibration_of(const driver::GloveInfo& glove, Side side,
                                         const CalibrationOptions& options) {
  if (options.calibration == "none") return hand::default_calibration(glove.counts);
  if (!options.calibration.empty()) return asked_for(glove, side, options.calibration);
  // The simulated wearer has the hand that the default is for.
  if (options.user.empty() && glove.source.starts_with("sim"))
    return hand::default_calibration(glove.counts);
  const auto stored = stored_calibrations();
  const auto choice = hand::choose_calibration(
      stored.files, {options.user, glove.model, serial_of(glove), side, glove.counts});
  if (choice) {
    tell(glove, *choice->file,
         choice->match == hand::GloveMatch::other_glove ? "; made with another glove of this model"
                                                        : "");
    return hand::calibration_for(choice->file->wearer, glove.counts);
  }
  if (!options.user.empty()) {
    return Error{Errc::bad_input, "--user " + printable(options.user) + ": no calibration of a " +
                                      std::string(name_of(side)) + " hand for " +
                                      printable(glove.source) +
                                      " is stored; `nendo calibration list` shows what is"};
  }
  return hand::default_calibration(glove.counts);
}

hand::Calibration swapped_calibration(const driver::GloveInfo& glove, Side side,
                                      const CalibrationOptions& options) {
  const bool any = options.calibration.empty() && !glove.source.starts_with("sim");
  const Side other = side == Side::left ? Side::right : Side::left;
  if (!any) return hand::default_calibration(glove.counts);
  const auto list = hand::list_calibrations(hand::calibration_folders());
  const auto choice = hand::choose_calibration(
      list.files, {options.user, glove.model, "", other, glove.counts}); // of an unknown number
  return choice ? hand::calibration_for(choice->file->wearer, glove.counts)
                : hand::default_calibration(glove.counts);
}

} // namespace nendo::app
