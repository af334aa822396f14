#pragma once
// Chooses a glove's calibration: the requested or stored one, the default, or learned ranges.

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include <nendo/base/result.hpp>
#include <nendo/driver/glove.hpp>
#include <nendo/driver/sample.hpp>
#include <nendo/hand/calibration_store.hpp>
#include <nendo/hand/wearer.hpp>

namespace nendo::sculpting {

/// Receives a one-line message for the user, on the calling thread.
using Note = std::function<void(std::string_view)>;

/// Returns the calibrations in the folders of the environment. Notes unreadable files. Blocks.
NENDO_API hand::CalibrationList stored_calibrations(const Note& note);

/// Returns the calibration of a name. A name with a slash or the extension .toml is a path; others
/// are wearers' names, which select from the wearer's calibrations in effect. Blocks. Errors:
/// bad_input (none, or unreadable), usage (ambiguous).
NENDO_API Result<hand::StoredCalibration> named_calibration(const std::string& name,
                                                            const Note& note);

/// Returns a text such as "Anna, right hand, glove A1".
NENDO_API std::string title_of(const hand::WearerCalibration& wearer);

/// Returns a list such as "index_pip and ring_mcp".
NENDO_API std::string sensors_in_words(SensorMask sensors);
NENDO_API bool is_one(SensorMask sensors) noexcept;

struct NENDO_API CalibrationOptions {
  std::string user;         ///< empty: any
  std::string calibration;  ///< a name for named_calibration(), or "none"; empty: the stored one
  bool adapt = false;       ///< learn the wearer's ranges, or the slips of a stored calibration
  std::string left_user{};  ///< overrides `user` for the left hand
  std::string right_user{}; ///< overrides `user` for the right hand

  const std::string& user_of(Side side) const noexcept;
  /// Returns the given users: "anna", or "left anna, right bob"; empty: none.
  std::string users() const;
};

struct FoundCalibration {
  enum class Kind : std::uint8_t {
    average,  ///< the calibration of an average hand
    stored,   ///< from a file
    recorded, ///< from the replayed recording
    learned,  ///< learned by --adapt
  } kind = Kind::average;
  std::string user;           ///< the wearer of the file, or of the learned ranges
  std::filesystem::path path; ///< the calibration file's path
};

constexpr std::string_view name_of(FoundCalibration::Kind kind) noexcept {
  constexpr std::array<std::string_view, 4> names{"average", "stored", "recorded", "learned"};
  return names[static_cast<std::size_t>(kind)];
}

/// Returns the serial number that the glove reports, or an empty text.
NENDO_API std::string serial_of(const driver::GloveInfo& glove);

/// Returns the best of the stored calibrations for this user (empty: any), glove and hand. The
/// result points into `stored`.
NENDO_API std::optional<hand::CalibrationChoice>
best_calibration(const hand::CalibrationList& stored, const driver::GloveInfo& glove, Side side,
                 const std::string& user);

/// Finds the calibrations of a glove that is made for `side`. For that side it takes the requested,
/// stored or recorded (if the glove replays) calibration, and notes the file, and whether it may be
/// for another glove, or that there is none. A simulated glove gets a stored one only on request.
/// For the other side it takes the stored or the default one, without a note. A user with
/// calibrations, but none for this hand and glove, gets the default one, with a note. Sets `found`,
/// if given, to the source for `side`. Blocks. Errors: bad_input (a missing or unreadable file, one
/// for the other hand, or a user without calibrations), usage.
NENDO_API Result<hand::Wearer> find_wearer(const driver::GloveInfo& glove, Side side,
                                           const CalibrationOptions& options, const Note& note,
                                           FoundCalibration* found = nullptr);

/// Returns whether a person wears the glove without a calibration for `side`: it is neither
/// simulated nor recorded, has the default calibration, and does not learn one.
NENDO_API bool is_uncalibrated(const driver::GloveInfo& glove, const hand::Wearer& wearer,
                               Side side);

} // namespace nendo::sculpting
