#pragma once
// Trackers and their poses for people and as JSON, for `nendo info`, `nendo monitor` and the
// summaries.

#include <array>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include <nendo/driver/open_tracker.hpp>

namespace nendo::gloves {

/// A turn as trackers' manuals give it: about z by the azimuth, then about the new y by the
/// elevation, then about the new x by the roll; right-handed, in degrees.
struct TurnAngles {
  double azimuth_deg = 0.0;
  double elevation_deg = 0.0;
  double roll_deg = 0.0;
};
/// Returns the angles of a quaternion of any length; not numbers if it has none.
TurnAngles angles_of(const std::array<double, 4>& turn_xyzw) noexcept;

/// Returns one object without a line end. Its keys are time_s, measured_s (host clock; of a
/// replayed pose those with which it was recorded, and replayed_s is the moment of replay),
/// sequence, source, station, position_m, turn_xyzw, azimuth_deg, elevation_deg, roll_deg, error
/// (the device's letter; null: none), and device_time_s if the tracker has a clock. What is not
/// finite is null.
std::string pose_json(const std::string& source, const PoseSample& pose);

/// Returns an object with the keys source, model, stations, rate_hz, filtered,
/// stage_from_tracker_xyzw and facts.
nlohmann::ordered_json tracker_json(const driver::TrackerInfo& info);

/// Returns "x away from the operator, y to the right, z down": how the tracker's axes usually lie
/// on the stage. A turn that is oblique is returned as a quaternion.
std::string axes_text(const driver::TrackerInfo& info);

/// Returns what to check if no pose of this station comes, in the imperative.
std::string no_pose_advice(const driver::TrackerStation& station);

/// What to do if a receiver was in the wrong hemisphere.
inline constexpr const char* hemisphere_advice =
    "the receiver has crossed the transmitter's hemisphere; mount it so that the hand stays on one "
    "side, or use hemisphere=";

} // namespace nendo::gloves
