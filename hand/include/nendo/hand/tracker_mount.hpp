#pragma once
// The mount of a tracker's station as a file: nendo calibrate tracker writes it, and runs read it.
// There is one file for each tracker, station and side, in a folder beside the calibrations of
// gloves. The format is TOML. Functions that take or find a path block on file I/O.

#include <array>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include <nendo/base/result.hpp>
#include <nendo/base/side.hpp>
#include <nendo/hand/wrist_tracking.hpp>

namespace nendo::hand {

/// What the file contains, in its units, so that reading and writing change no bit.
struct TrackerMount {
  std::string tracker; ///< as tracker_name() returns it; one line of UTF-8, at most 200 bytes
  std::uint16_t station = 0;
  Side side = Side::right;
  bool on_hand = false;                        ///< `mounted`: "forearm" or "hand"
  std::array<double, 3> position_mm{};         ///< position of the wrist in the station frame
  std::array<double, 4> turn_xyzw{0, 0, 0, 1}; ///< wrist to station
  std::array<double, 4> stage_from_tracker_xyzw{0, 0, 0, 1};
  double late_ms = 0.0;
  double residual_mm = 0.0;         ///< the residual of the exercise
  std::chrono::sys_seconds taken{}; ///< UTC, 1970 to 9999
  friend bool operator==(const TrackerMount&, const TrackerMount&) = default;
};

NENDO_API WristMount wrist_mount(const TrackerMount& mount) noexcept;
/// Sets position, turns, lateness and place from a mount.
NENDO_API void set_mount(TrackerMount& file, const WristMount& mount) noexcept;

/// Returns the kind and target of a specification, without options: "fastrak:/dev/ttyUSB2".
NENDO_API std::string tracker_name(std::string_view source);

/// Reads the text of a mount file. The reader is strict, as parse_calibration(). Fails with
/// bad_input, "NAME:LINE: what; remedy".
NENDO_API Result<TrackerMount> parse_mount(std::string_view text, std::string_view name);
/// Returns a text that parse_mount() parses to the same bits. Fails with bad_input, naming the
/// value that cannot be written.
NENDO_API Result<std::string> mount_text(const TrackerMount& mount);

/// Fails with bad_input, also if it is not a regular file or is larger than 1 MiB.
NENDO_API Result<TrackerMount> read_mount(const std::filesystem::path& path);
/// Replaces the file atomically, and creates its folder if needed. Errors: bad_input (as
/// mount_text()), failed (the disk).
NENDO_API Result<void> write_mount(const std::filesystem::path& path, const TrackerMount& mount);

/// Returns $XDG_CONFIG_HOME/nendo/mounts/TRACKER+STATION+SIDE.toml, which need not exist; for the
/// folder, see calibration_folders(). `tracker` is a name or a whole specification. Error: failed,
/// if this user has no folder.
NENDO_API Result<std::filesystem::path> own_mount_path(std::string_view tracker,
                                                       std::uint16_t station, Side side);
/// Reads this user's mount or else that of all users, in /etc/nendo/mounts. nullopt if there is
/// none. Error: bad_input, if the file cannot be read.
NENDO_API Result<std::optional<TrackerMount>> find_mount(std::string_view tracker,
                                                         std::uint16_t station, Side side);

} // namespace nendo::hand
