#pragma once
// Chooses between the full fit and the quick one.

#include <span>

#include <nendo/hand/calibration_fit.hpp>

#include "fit_solver.hpp"

namespace nendo::hand {

/// Puts the quick fit's lines in place of the full fit's for each group of like joints of which
/// they predict poses better that were held out: the full fit is made again without a quarter of
/// the takes, four times, and both are asked for the angles of these. Flat and fist are never held
/// out, because the quick fit rests on them. `solution` is the full fit's.
void choose_by_held_out_poses(CalibrationFit& fit, std::span<const PoseReading> readings, Side side,
                              SensorMask sensors, const FitOptions& options,
                              const Solution& solution);

} // namespace nendo::hand
