#pragma once
// The laws of readers of other programs' calibrations.

#include <cmath>
#include <string>

#include <nendo/hand/calibration_exchange.hpp>
#include <nendo/hand/calibration_file.hpp>

#include "laws.hpp"

/// Such a reader returns an error, or finite lines that a calibration file can hold.
inline void check_imported(const nendo::Result<nendo::hand::ImportedCalibration>& read) {
  if (!read) return require_one_line(read.error());
  for (const std::string& note : read->notes)
    require(note.find('\n') == std::string::npos);
  for (const auto& line : read->calibration.sensors)
    require(std::isfinite(line.angle_rad(nendo::RawCount{65535})));
  nendo::hand::WearerCalibration wearer;
  wearer.user = "fuzz";
  wearer.method = "imported";
  wearer.calibration = read->calibration;
  require(static_cast<bool>(nendo::hand::calibration_text(wearer)));
}
