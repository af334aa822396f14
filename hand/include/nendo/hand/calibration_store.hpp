#pragma once
// Lists calibration files and chooses one for a glove. The content of a file decides; its name is
// only a unique key.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/hand/calibration_file.hpp>

namespace nendo::hand {

struct CalibrationFolders {
  std::filesystem::path own;    ///< this user's; empty: none
  std::filesystem::path shared; ///< all users'; empty: none
};

/// Returns $XDG_CONFIG_HOME/nendo/calibrations (without that variable in ~/.config, where the home
/// folder comes from $HOME or else from the password file), and /etc/nendo/calibrations. Reads the
/// environment, which no other thread may change meanwhile.
NENDO_API CalibrationFolders calibration_folders();

/// Returns "USER+GLOVE+HAND.toml", where an empty serial number becomes "any". Different users,
/// gloves and hands give different names. Every name is at most 200 characters of [A-Za-z0-9_+%.-],
/// for any arguments.
NENDO_API std::string calibration_file_name(const std::string& user,
                                            const std::string& glove_serial, Side side);

/// Returns the path of this user's own calibration, which need not exist. Error: failed, if this
/// user has no folder.
NENDO_API Result<std::filesystem::path>
own_calibration_path(const std::string& user, const std::string& glove_serial, Side side);

struct StoredCalibration {
  std::filesystem::path path;
  bool shared = false; ///< from the shared folder
  WearerCalibration wearer;
};

struct CalibrationList {
  std::vector<StoredCalibration> files; ///< own files first, sorted by name per folder
  std::vector<Error> unreadable;        ///< one error per unreadable file or folder
};

/// Reads the calibrations of both folders, without earlier versions. A missing folder counts as
/// empty. Blocks.
NENDO_API CalibrationList list_calibrations(const CalibrationFolders& folders);

struct GloveIdentity {
  std::string user; ///< empty: any
  std::string model;
  std::string serial; ///< empty if the glove reports none
  Side side = Side::right;
  CountScale counts;
};

/// How well a calibration fits a glove; better matches are greater.
enum class GloveMatch : std::uint8_t {
  other_glove, ///< made with another glove of this model
  any_glove,   ///< made for no particular glove
  this_glove,
};

struct CalibrationChoice {
  const StoredCalibration* file; ///< an element of `files`
  GloveMatch match;
};

/// Returns the best calibration for `glove`, or nullopt. It is never one of another user, side,
/// model or CountScale::self_calibrated. Among equal matches, own files precede shared ones, then
/// newer files older ones, then the first in `files` is chosen. `files` must outlive the choice.
NENDO_API std::optional<CalibrationChoice>
choose_calibration(const std::vector<StoredCalibration>& files, const GloveIdentity& glove);

/// Returns whether choose_calibration() chooses this file for its own user, glove and side.
NENDO_API bool is_active_calibration(const StoredCalibration& file,
                                     const std::vector<StoredCalibration>& files);

} // namespace nendo::hand
