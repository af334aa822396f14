#pragma once
// What the fit of a calibration assumes before it has seen a pose: how far gloves and wearers are
// from the default, how far joints go, and how much a single residual may count.

#include <array>
#include <cmath>

#include <nendo/driver/sample.hpp>
#include <nendo/hand/wearer_shape.hpp>

namespace nendo::hand {

// How uncertain the default is. Published gains differ by as much between gloves and wearers. Gaps
// between fingers need it: the poses that spread them are few and loosely held, and a wider prior
// made their errors greater by a fifth. Published offsets differ by half of theirs, so that one or
// two poses outweigh it.
inline constexpr double gain_deviation = 0.22; ///< the logarithm's: a gain's sign is known
inline constexpr double offset_deviation_of_range = 40.0 / 255.0;
// Thumb sensors mix strongly; published slope matrices have ratios up to 0.9.
inline constexpr double thumb_mix_deviation = 0.5;
inline constexpr double gap_mix_deviation = 0.2;

// How the flesh differs between wearers.
inline constexpr double pad_depth_deviation_m = 0.002;
inline constexpr double pad_behind_deviation_m = 0.003;
inline constexpr double palm_depth_deviation_m = 0.003;

// How hands differ. The sizes are ANSUR II's, women and men together; the breadth is what is left
// of it when the length is known. Bones vary by 7 to 14 % between people of all sizes (A. Buryanov,
// V. Kotiuk, Int. J. Morphol. 28, 2010), of which the size takes its part. The carpometacarpal
// axes of the thumb differ by 5 to 10 degrees between specimens (W. P. Cooney and others, 1981; A.
// Hollister and others, 1992). Models of the thumb differ more than specimens of one study do,
// above all in how a thumb turns about itself as it opposes: axes that are square and fixed turn it
// twice as far as those of turns.hpp. The deviations of its turn cover both, for a touch that
// is believed as if the thumb were better known pulls roll and abduction off. All but ANSUR's are
// quoted from memory.
inline constexpr double length_deviation = 0.06; ///< the logarithm's
inline constexpr double breadth_deviation = 0.05;
constexpr double shape_deviation(ShapeTerm term) noexcept {
  if (term <= ShapeTerm::little_distal) return 0.06;
  if (term <= ShapeTerm::thumb_base_z) return 0.006;
  if (term == ShapeTerm::pad_depth) return pad_depth_deviation_m;
  if (term == ShapeTerm::pad_behind) return pad_behind_deviation_m;
  if (term >= ShapeTerm::thumb_pronation_by_roll) return 0.8;
  constexpr double degree = 0.017453292519943295;
  if (term == ShapeTerm::thumb_pronation) return 20.0 * degree;
  return (term < ShapeTerm::index_tilt ? 10.0 : 7.0) * degree;
}

// Even the right terms leave an error of a hand's form, in each coordinate of a touch.
inline constexpr double form_deviation_m = 0.0045;

// How far sensors slip between wearings before anything is known of a wearing: the vendor's figure
// of repeatability is 3 degrees. These are the least and the most that a touch-up believes.
inline constexpr double min_slip_rad = 0.009;
inline constexpr double max_slip_rad = 0.11;

// How surely a wearer who goes to both ends of a joint's range comes to the middle between them
// again: either end differs by some two degrees from one time to the next.
inline constexpr double middle_of_ends_deviation_rad = 0.02;
// A free motion over less than this fraction of a joint's range did not reach its ends.
inline constexpr double min_part_of_range = 0.5;

// Beyond this many deviations a residual counts by its size and no longer by its square. So a pose
// that was held badly, or another pose than was asked for, does not spoil what the other poses
// agree on.
inline constexpr double unusual = 2.0;

// Where wearers bend a joint by feel, this part of their error is a habit, which is the same in all
// poses of the joint. The square of this part is about a sixth, so the habit is a sixth of the
// variance. The poses alone cannot separate a habit from a gain.
inline constexpr double habit_part = 0.4;

// A PIP joint that is asked to be straight cannot go much beyond that, so that it is off to one
// side: half of a normal scatter of 3 to 5 degrees stops at two degrees of hyperextension.
inline constexpr double straight_pip_rad = 0.014;

// In a pose the joint's angle differs from the angle that was asked for, and the counts follow the
// joint. A line should therefore be fitted to counts over asked angles. With residuals in radians,
// the best line becomes flatter the more the poses scatter, because a small gain makes small
// residuals (regression dilution: W. A. Fuller, "Measurement Error Models", 1987). This does not
// happen with residuals in counts, whose deviations are those in radians divided by the gain of the
// last iteration; but where few poses bend a joint, the line is then uncertain. For the wearers
// used in tuning, errors were least this far from radians to counts, by a geometric mean of both
// deviations.
inline constexpr double scatter_in_counts = 0.4;

// Residuals that are set aside weigh so little.
inline constexpr double set_aside_weight = 1e-4;

// A free motion that stays this far behind the poses did not reach the end.
inline constexpr double short_of_poses_rad = 0.05;

// How far joints go, and how far people and published tables differ: means of the American Academy
// of Orthopaedic Surgeons' (MCP 90, PIP 100, DIP 80 to 90 by edition; thumb 50 and 80; wrist 80 and
// -70, 20 and -30), of those of the Electronic Textbook of Hand Surgery (90, 100, 80; 55 and 80; 75
// and -70, 20 and -35), and for wrists of D. C. Boone and S. P. Azen's, J. Bone Joint Surg. 61-A,
// 1979 (76, -75, 22, -36, as reference tables for goniometry quote them). From memory alone, and
// not found again, are the active ranges of M. C. Hume and others, J. Hand Surg. 15A, 1990 (100,
// 105, 85; thumb 56 and 73), whose abstract has the functional ones; a thumb's MCP joint of 59,
// from 16 to 90, in 300 hands; deviations of 6 and 4 in wrists. For PIP joints tables say up to
// 120. The straight ends of flexion are not used, because poses determine them better.
struct RangeEnds {
  double low_deg, low_deviation_deg, high_deg, high_deviation_deg; // deviation 0: not used
};
inline constexpr RangeEnds mcp_ends{0, 0, 93, 7};
inline constexpr RangeEnds pip_ends{0, 0, 103, 8};
inline constexpr RangeEnds dip_ends{0, 0, 81, 8};
inline constexpr RangeEnds no_ends{};
inline constexpr std::array<RangeEnds, sensor_slots> range_ends_of{{
    no_ends,  {0, 0, 58, 13},  {0, 0, 79, 9},   no_ends, // thumb
    mcp_ends, pip_ends,        dip_ends,        no_ends, // index
    mcp_ends, pip_ends,        dip_ends,        no_ends, // middle
    mcp_ends, pip_ends,        dip_ends,        no_ends, // ring
    mcp_ends, pip_ends,        dip_ends,        no_ends, // little
    no_ends,  {-72, 7, 78, 7}, {-33, 5, 21, 4}, no_ends, // palm, wrist
}};

/// The residual that pseudo-Huber's loss makes of a residual, so that its square is the loss, and
/// its slope (P. Charbonnier and others, 1997).
struct Robust {
  double residual, slope;
};
inline Robust robust(double residual) noexcept {
  const double part = residual / unusual;
  const double root = std::sqrt(1.0 + part * part);
  const double loss = 2.0 * unusual * unusual * (part * part / (root + 1.0));
  if (loss < 1e-20) return {residual, 1.0};
  const double size = std::sqrt(loss);
  return {std::copysign(size, residual), std::abs(residual) / (root * size)};
}

} // namespace nendo::hand
