#pragma once
// The settings of an emulated FASTRAK, and its commands with parameters, which set them. The facts
// are those of the FASTRAK manual (OPM00PI002 Rev. G, June 2012); comments in the .cpp file name
// what it leaves open.

#include <array>
#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "units/rotation.hpp"
#include "units/unit_message.hpp"

namespace nendo::emulator::fastrak {

inline constexpr std::size_t max_stations = 4;
inline constexpr double inch_cm = 2.54;

/// Where a receiver is, in centimetres, and how it is turned.
struct StationPose {
  Vector3 position_cm{};
  Rotation attitude = no_rotation;
};

struct StationSettings {
  bool on = false;
  std::vector<unsigned> items{2, 4, 1}; ///< the output list
  Vector3 hemisphere{1, 0, 0};          ///< towards its zenith; 0 0 0: the hemisphere is tracked
  double tracked_sign = 1.0;            ///< sign of the reported solution, while it is tracked
  std::array<double, 1> increment_cm{}; ///< the least movement between two records of a stream
  std::array<double, 9> alignment_cm{0, 0, 0, 200, 0, 0, 0, 200, 0}; ///< origin, on x, on y
  std::array<double, 3> reference_deg{}; ///< what the boresight makes of the present attitude
  Rotation boresight = no_rotation;      ///< a turn of the receiver's own axes
  std::array<double, 3>
      mounting_deg{};             ///< how the transmitter is mounted: azimuth, elevation, roll
  std::array<double, 3> tip_cm{}; ///< the offset of a stylus' tip
  std::array<double, 1> button_output{1}; ///< 1: the stylus' button starts and stops the stream

  /// Returns whether the unit takes the solution at -p for this receiver at p.
  bool is_flipped(const Vector3& position_cm) const noexcept;
  /// Returns what the unit reports of a receiver: hemisphere, mounting, alignment, tip, boresight.
  StationPose reported(const StationPose& receiver) const noexcept;
};

struct Settings {
  std::array<StationSettings, max_stations> stations;
  bool binary = false;
  bool centimetres = false;
  std::array<double, 4> position_filter{0.2, 0.2, 0.8, 0.8}; ///< kept, and not applied
  std::array<double, 4> attitude_filter{0.2, 0.2, 0.8, 0.8};
  std::array<double, 1> synchronisation{}; ///< 0 internal, 1 external, 2 video coil

  double unit_cm() const noexcept { return centimetres ? 1.0 : inch_cm; }
};

/// What the carrying out of a command must know of the receivers.
struct Receivers {
  std::array<bool, max_stations> plugged{};
  std::function<StationPose(std::size_t station)> pose; ///< now; stations count from 0
};

/// Returns whether this letter begins a command whose parameters end with CR.
bool takes_parameters(unit::Byte letter) noexcept;

/// Carries out a command, which is a letter and parameters without the CR. Returns the answer,
/// which is empty for most commands; the answer to a wrong one says what is wrong.
std::string carry_out(std::string_view command, Settings& settings, const Receivers& receivers);

/// Codes of wrong commands.
enum class Wrong : int {
  field_missing = -1,
  no_number = -2,
  out_of_range = -3,
  too_long = -5,
  unknown = -99
};
/// Returns the answer to a wrong command. Positions, fields and stations count from 0.
std::string error_answer(std::string_view command, Wrong wrong, std::size_t position = 0,
                         std::size_t field = 0, std::size_t station = 0);

} // namespace nendo::emulator::fastrak
