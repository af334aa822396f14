#include <nendo/sculpting/calibration_names.hpp>

#include <bit>
#include <utility>
#include <vector>

#include <nendo/base/endings.hpp>
#include <nendo/base/text.hpp>

namespace nendo::sculpting {
namespace {

using hand::StoredCalibration;

std::string stem_of(const StoredCalibration& file) {
  return file.path.stem().string();
}

} // namespace

hand::CalibrationList stored_calibrations(const Note& note) {
  auto list = hand::list_calibrations(hand::calibration_folders());
  for (const auto& error : list.unreadable)
    note(printable(error.message));
  return list;
}

Result<StoredCalibration> named_calibration(const std::string& name, const Note& note) {
  if (name.find('/') != std::string::npos || ends_in(name, ".toml")) {
    auto wearer = hand::read_calibration(name);
    if (!wearer) return wearer.error();
    return StoredCalibration{name, false, *std::move(wearer)};
  }
  const auto list = stored_calibrations(note);
  std::vector<const StoredCalibration*> meant;
  for (const auto& file : list.files) {
    if (stem_of(file) == name) return file; // the user's own comes first
    if (file.wearer.user == name && is_in_force(file, list.files)) meant.push_back(&file);
  }
  if (meant.size() == 1) return *meant.front();
  if (meant.empty()) {
    return Error{Errc::bad_input, printable(name) + ": no such calibration is stored; "
                                                    "`nendo calibration list` shows them"};
  }
  std::string several;
  for (const auto* file : meant)
    several.append(several.empty() ? "" : " or ").append(stem_of(*file));
  return Error{Errc::usage, printable(name + ": several are meant; name " + several)};
}

std::string title_of(const hand::WearerCalibration& wearer) {
  return printable(wearer.user + ", " + std::string(name_of(wearer.side)) + " hand, " +
                   (wearer.glove_serial.empty() ? "any glove" : "glove " + wearer.glove_serial));
}

bool is_one(SensorMask sensors) noexcept {
  return std::popcount(sensors.bits) == 1;
}

std::string sensors_in_words(SensorMask sensors) {
  std::string text;
  int left = std::popcount(sensors.bits);
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    if (!sensors.has(static_cast<Sensor>(slot))) continue;
    text.append(name_of(static_cast<Sensor>(slot)));
    --left;
    if (left > 0) text += left == 1 ? " and " : ", ";
  }
  return text;
}

} // namespace nendo::sculpting
