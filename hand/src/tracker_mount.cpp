#include <nendo/hand/tracker_mount.hpp>

#include <algorithm>
#include <cmath>
#include <system_error>

#include <nendo/base/files.hpp>
#include <nendo/base/text.hpp>
#include <nendo/hand/calibration_store.hpp>

#include "calibration_check.hpp"
#include "file_name_part.hpp"
#include "mount_check.hpp"
#include "toml_text.hpp"

namespace nendo::hand {
namespace {

namespace fs = std::filesystem;

constexpr double max_position_mm = 1000.0;
constexpr double max_late_ms = 1000.0;
constexpr double max_residual_mm = 1000.0;
constexpr double max_norm_difference = 1e-3;

// Written so that NaN is no unit quaternion.
bool is_unit(const std::array<double, 4>& quaternion) noexcept {
  double square = 0.0;
  for (const double part : quaternion)
    square += part * part;
  return std::abs(std::sqrt(square) - 1.0) <= max_norm_difference;
}

bool is_on_arm(const std::array<double, 3>& position_mm) noexcept {
  return std::all_of(position_mm.begin(), position_mm.end(),
                     [](double part) { return std::abs(part) <= max_position_mm; });
}

Eigen::Quaterniond quaternion_of(const std::array<double, 4>& xyzw) noexcept {
  return Eigen::Quaterniond(xyzw[3], xyzw[0], xyzw[1], xyzw[2]).normalized();
}

std::array<double, 4> xyzw_of(const Eigen::Quaterniond& turn) noexcept {
  return {turn.x(), turn.y(), turn.z(), turn.w()};
}

template <std::size_t Size>
std::string list_text(const std::array<double, Size>& values) {
  std::string text;
  for (const double value : values)
    text.append(text.empty() ? "[" : ", ").append(decimal_text(value));
  return text + "]";
}

std::string mount_file_name(std::string_view tracker, std::uint16_t station, Side side) {
  return file_name_part(tracker_name(tracker)) + "+" + std::to_string(station) + "+" +
         std::string(name_of(side)) + ".toml";
}

} // namespace

std::string complaint_about(const TrackerMount& mount) {
  using namespace std::chrono;
  if (const std::string complaint = complaint_about_text(mount.tracker, false); !complaint.empty())
    return "tracker " + in_quotes(mount.tracker) + ": " + complaint;
  if (!is_on_arm(mount.position_mm))
    return "position_mm must have numbers within -1000 and 1000: the station is on the arm";
  if (!is_unit(mount.turn_xyzw)) return "turn_xyzw must be a quaternion of length 1";
  if (!is_unit(mount.stage_from_tracker_xyzw))
    return "stage_from_tracker_xyzw must be a quaternion of length 1";
  if (!(std::abs(mount.late_ms) <= max_late_ms)) return "late_ms must lie within -1000 and 1000";
  if (!(mount.residual_mm >= 0.0 && mount.residual_mm <= max_residual_mm))
    return "residual_mm must lie within 0 and 1000";
  if (mount.taken < sys_seconds{} || mount.taken >= sys_days{year{10000} / 1 / 1})
    return "taken must lie within the years 1970 and 9999";
  return {};
}

WristMount wrist_mount(const TrackerMount& file) noexcept {
  WristMount mount;
  mount.stage_from_tracker = quaternion_of(file.stage_from_tracker_xyzw);
  mount.T_station_wrist.linear() = quaternion_of(file.turn_xyzw).toRotationMatrix();
  mount.T_station_wrist.translation() =
      1e-3 * Eigen::Vector3d(file.position_mm[0], file.position_mm[1], file.position_mm[2]);
  mount.on_hand = file.on_hand;
  mount.late_s = 1e-3 * file.late_ms;
  return mount;
}

void set_mount(TrackerMount& file, const WristMount& mount) noexcept {
  const Eigen::Vector3d position = 1e3 * mount.T_station_wrist.translation();
  file.position_mm = {position.x(), position.y(), position.z()};
  file.turn_xyzw = xyzw_of(Eigen::Quaterniond(mount.T_station_wrist.linear()));
  file.stage_from_tracker_xyzw = xyzw_of(mount.stage_from_tracker);
  file.on_hand = mount.on_hand;
  file.late_ms = 1e3 * mount.late_s;
}

std::string tracker_name(std::string_view source) {
  return std::string(source.substr(0, source.find('?')));
}

Result<std::string> mount_text(const TrackerMount& mount) {
  if (const std::string complaint = complaint_about(mount); !complaint.empty())
    return Error{Errc::bad_input, "this mount cannot be written: " + complaint};
  return "# Where the wrist is in the frame of a tracker's station.\n"
         "version = 1\n"
         "tracker = " +
         toml_string(mount.tracker) + "\nstation = " + std::to_string(mount.station) +
         "\nside = \"" + std::string(name_of(mount.side)) + "\"\nmounted = \"" +
         (mount.on_hand ? "hand" : "forearm") +
         "\"\nposition_mm = " + list_text(mount.position_mm) +
         "\nturn_xyzw = " + list_text(mount.turn_xyzw) +
         "\nstage_from_tracker_xyzw = " + list_text(mount.stage_from_tracker_xyzw) +
         "\nlate_ms = " + decimal_text(mount.late_ms) +
         "\nresidual_mm = " + decimal_text(mount.residual_mm) +
         "\ntaken = " + rfc3339(mount.taken) + "\n";
}

Result<TrackerMount> read_mount(const fs::path& path) {
  const auto text = read_file(path, max_calibration_bytes, "mount of a tracker");
  if (!text) return text.error();
  return parse_mount(*text, path.string());
}

Result<void> write_mount(const fs::path& path, const TrackerMount& mount) {
  const auto text = mount_text(mount);
  if (!text) return text.error();
  std::error_code failed;
  if (path.has_parent_path()) fs::create_directories(path.parent_path(), failed);
  if (failed)
    return Error{Errc::failed, path.parent_path().string() + ": the folder cannot be made: " +
                                   failed.message() + "; make it or choose another"};
  return replace_file(path, *text);
}

Result<fs::path> own_mount_path(std::string_view tracker, std::uint16_t station, Side side) {
  const fs::path calibrations = calibration_folders().own;
  if (calibrations.empty())
    return Error{Errc::failed, "you have no home folder; set XDG_CONFIG_HOME to a folder"};
  return calibrations.parent_path() / "mounts" / mount_file_name(tracker, station, side);
}

Result<std::optional<TrackerMount>> find_mount(std::string_view tracker, std::uint16_t station,
                                               Side side) {
  const CalibrationFolders folders = calibration_folders();
  for (const fs::path& folder : {folders.own, folders.shared}) {
    if (folder.empty()) continue;
    const fs::path path = folder.parent_path() / "mounts" / mount_file_name(tracker, station, side);
    std::error_code failed;
    if (!fs::exists(path, failed)) continue;
    auto mount = read_mount(path);
    if (!mount) return mount.error();
    return std::optional(*std::move(mount));
  }
  return std::optional<TrackerMount>();
}

} // namespace nendo::hand
