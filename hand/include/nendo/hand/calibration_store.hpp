#pragma once
// Where calibration files lie, and which of them is for the glove at hand. What counts is what a
// file says; its name only keeps files apart.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/hand/calibration_file.hpp>

namespace nendo::hand {

struct CalibrationFolders {
  std::filesystem::path own;    ///< of this user; empty: none
  std::filesystem::path shared; ///< of all users; empty: none
};

/// $XDG_CONFIG_HOME/nendo/calibrations (~/.config without it; the home folder from $HOME or else
/// the password file), and /etc/nendo/calibrations. Reads the environment: no other thread may set
/// it meanwhile.
CalibrationFolders calibration_folders();

/// "USER+GLOVE+HAND.toml", where an empty serial number is "any". Different users, gloves and hands
/// give different names, each at most 200 characters of [A-Za-z0-9_+%.-], whatever was given.
std::string calibration_file_name(const std::string& user, const std::string& glove_serial,
                                  Side side);

struct StoredCalibration {
  std::filesystem::path path;
  bool shared = false; ///< from the folder of all users
  WearerCalibration wearer;
};

struct CalibrationList {
  std::vector<StoredCalibration> files; ///< own ones first, each folder's by name
  std::vector<Error> unreadable;        ///< files, and folders that exist, one error each
};

/// All of both folders but earlier versions; a missing folder is an empty one. Blocks.
CalibrationList list_calibrations(const CalibrationFolders& folders);

/// What is known of a glove that needs a calibration.
struct GloveAtHand {
  std::string user; ///< empty: whoever
  std::string model;
  std::string serial; ///< empty: it does not tell
  Side side = Side::right;
  CountScale counts;
};

/// Better ones are greater.
enum class GloveMatch : std::uint8_t {
  other_glove, ///< made with another glove of this model
  any_glove,   ///< made for no particular glove
  this_glove,
};

struct CalibrationChoice {
  const StoredCalibration* file; ///< one of those given
  GloveMatch match;
};

/// The best for that glove, or nothing. Never one of the other hand, of another model or of other
/// kinds of counts. Of equally good ones an own file goes before a shared one, then the newer, then
/// the one listed first. `files` must outlive the choice.
std::optional<CalibrationChoice> choose_calibration(const std::vector<StoredCalibration>& files,
                                                    const GloveAtHand& glove);

/// Whether the file is what choose_calibration() gives for its own user, glove and hand.
bool is_in_force(const StoredCalibration& file, const std::vector<StoredCalibration>& files);

} // namespace nendo::hand
