#pragma once
// Chooses the wearer of a glove: the requested calibration, the stored one, the default, or learned
// ranges.

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

/// Receives a notice for the user in one line, on the thread of the function that it is given to.
using Note = std::function<void(std::string_view)>;

/// Returns the calibrations in the folders that the environment gives. Notes which files cannot be
/// read. Blocks.
NENDO_API hand::CalibrationList stored_calibrations(const Note& note);

/// Returns the calibration that `name` means. A text with a slash or the ending .toml is a path. A
/// wearer's name means those of the wearer's calibrations that are in effect. Blocks. Errors:
/// bad_input (there is none, or it cannot be read), usage (several are meant).
NENDO_API Result<hand::StoredCalibration> named_calibration(const std::string& name,
                                                            const Note& note);

/// Returns a text such as "Anna, right hand, glove A1".
NENDO_API std::string title_of(const hand::WearerCalibration& wearer);

/// Returns "index_pip", or "index_pip and ring_mcp", and so on.
NENDO_API std::string sensors_in_words(SensorMask sensors);
NENDO_API bool is_one(SensorMask sensors) noexcept;

struct NENDO_API CalibrationOptions {
  std::string user;         ///< empty: any
  std::string calibration;  ///< as named_calibration() takes it, or "none"; empty: the stored one
  bool adapt = false;       ///< learn the wearer's ranges, or the slips of such a calibration
  std::string left_user{};  ///< the left hand's, in place of `user`
  std::string right_user{}; ///< the right hand's, in place of `user`

  const std::string& user_of(Side side) const noexcept;
  /// All that were given, as "anna", or "left anna, right bob"; empty: none.
  std::string users() const;
};

struct FoundCalibration {
  enum class Kind : std::uint8_t {
    average,  ///< the calibration of an average hand
    stored,   ///< a file's
    recorded, ///< the replayed recording's
    learned,  ///< what --adapt learns
  } kind = Kind::average;
  std::string user;           ///< the wearer of the file, or of the learned ranges
  std::filesystem::path path; ///< the file's
};

constexpr std::string_view name_of(FoundCalibration::Kind kind) noexcept {
  constexpr std::array<std::string_view, 4> names{"average", "stored", "recorded", "learned"};
  return names[static_cast<std::size_t>(kind)];
}

/// Returns the serial number that the glove reports, or an empty text.
NENDO_API std::string serial_of(const driver::GloveInfo& glove);

/// Returns the best of the stored calibrations for this user (empty: any), glove and hand. It
/// points into `stored`.
NENDO_API std::optional<hand::CalibrationChoice>
best_calibration(const hand::CalibrationList& stored, const driver::GloveInfo& glove, Side side,
                 const std::string& user);

/// Finds the wearer of a glove that is sewn for `side`. For that side the wearer gets the hand that
/// is asked for, stored, or recorded (if the glove replays); a note says which
/// file it is, and whether it may be that of another glove, or that there is none. A simulated
/// glove gets a stored hand only on request. For the other side the wearer gets the stored
/// hand or an average one, and nothing is noted. A user who has calibrations, but none for this
/// hand and glove, gets an average hand, and a note says so. `found`, if given, is set to what
/// the wearer of `side` has. Blocks. Errors: bad_input (no such file, another hand's, not readable,
/// a user without any calibration), usage.
NENDO_API Result<hand::Wearer> find_wearer(const driver::GloveInfo& glove, Side side,
                                           const CalibrationOptions& options, const Note& note,
                                           FoundCalibration* found = nullptr);

/// Returns whether angles of that side are an average hand's, though a person wears the glove: it
/// is neither simulated nor recorded, has the default calibration, and learns none.
NENDO_API bool is_uncalibrated(const driver::GloveInfo& glove, const hand::Wearer& wearer,
                               Side side);

} // namespace nendo::sculpting
