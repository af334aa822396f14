#include "markers/camera_model.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>

#include <nendo/base/files.hpp>
#include <nendo/base/text.hpp>
#include <nendo/base/units.hpp>

#include "config/toml_reader.hpp"

namespace nendo::markers {
namespace {

constexpr std::uint64_t max_size_px = 16'384;
constexpr std::uint64_t max_file_bytes = 65'536;
constexpr double assumed_view_deg = 60.0;

template <std::size_t Size>
std::string list_text(const std::array<double, Size>& numbers) {
  std::string text;
  for (const double number : numbers)
    text += (text.empty() ? "[" : ", ") + decimal_text(number);
  return text + "]";
}

void read_root(config::TomlReader& reader, const toml::table& root, CameraModel& camera) {
  reader.allow_only(root, {"version", "width_px", "height_px", "focal_px", "centre_px",
                           "distortion", "error_px"});
  camera.width_px = static_cast<int>(reader.count(root, "width_px", max_size_px, 16));
  camera.height_px = static_cast<int>(reader.count(root, "height_px", max_size_px, 16));
  const auto read = [&](std::string_view key, auto& numbers) {
    const toml::node* const node = reader.find(root, key);
    if (node == nullptr) return;
    numbers = reader.numbers<std::tuple_size_v<std::decay_t<decltype(numbers)>>>(*node, key);
  };
  read("focal_px", camera.focal_px);
  read("centre_px", camera.centre_px);
  read("distortion", camera.distortion);
  camera.error_px = reader.number(root, "error_px");
  if (reader.error()) return;
  const double size_px = camera.width_px + camera.height_px;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    if (!(camera.focal_px[axis] > size_px / 50 && camera.focal_px[axis] < size_px * 50))
      reader.complain(*root.get("focal_px"), "focal_px is no camera's; calibrate it again");
    if (!(std::abs(camera.centre_px[axis]) < size_px))
      reader.complain(*root.get("centre_px"), "centre_px is far outside of the picture");
  }
  for (const double number : camera.distortion)
    if (!(std::abs(number) < 100.0))
      reader.complain(*root.get("distortion"), "distortion is no lens's; calibrate it again");
}

} // namespace

cv::Matx33d CameraModel::matrix() const {
  return {focal_px[0], 0, centre_px[0], 0, focal_px[1], centre_px[1], 0, 0, 1};
}

CameraModel assumed_camera(int width_px, int height_px) {
  CameraModel camera;
  camera.width_px = width_px;
  camera.height_px = height_px;
  const double focal_px = width_px / 2.0 / std::tan(from_degrees(assumed_view_deg / 2));
  camera.focal_px = {focal_px, focal_px};
  camera.centre_px = {(width_px - 1) / 2.0, (height_px - 1) / 2.0};
  return camera;
}

std::string to_toml(const CameraModel& camera) {
  return "# A camera, as nendo-markers calibrate measured it\nversion = 1\nwidth_px = " +
         std::to_string(camera.width_px) + "\nheight_px = " + std::to_string(camera.height_px) +
         "\nfocal_px = " + list_text(camera.focal_px) +
         "\ncentre_px = " + list_text(camera.centre_px) +
         "\ndistortion = " + list_text(camera.distortion) +
         "\nerror_px = " + decimal_text(camera.error_px) + "\n";
}

Result<CameraModel> camera_from_toml(std::string_view text, std::string_view name) {
  CameraModel camera;
  const auto error = config::read_toml(
      text, name,
      [&](config::TomlReader& reader, const toml::table& root) { read_root(reader, root, camera); },
      "calibrate the camera again");
  if (error) return *error;
  return camera;
}

Result<CameraModel> read_camera(const std::filesystem::path& path) {
  const auto text = read_file(path, max_file_bytes, "calibration of a camera");
  if (!text) return text.error();
  return camera_from_toml(*text, path.string());
}

Result<CameraModel> scaled_to(const CameraModel& camera, int width_px, int height_px) {
  const double scale = static_cast<double>(width_px) / camera.width_px;
  if (std::abs(scale * camera.height_px - height_px) > 1.0)
    return Error{Errc::usage, "the camera was calibrated with pictures of " +
                                  std::to_string(camera.width_px) + " x " +
                                  std::to_string(camera.height_px) + " and sends " +
                                  std::to_string(width_px) + " x " + std::to_string(height_px) +
                                  "; calibrate it again"};
  CameraModel scaled = camera;
  scaled.width_px = width_px;
  scaled.height_px = height_px;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    scaled.focal_px[axis] *= scale;
    scaled.centre_px[axis] = (scaled.centre_px[axis] + 0.5) * scale - 0.5;
  }
  return scaled;
}

} // namespace nendo::markers
