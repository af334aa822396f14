#include "markers/markers_commands.hpp"

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <iostream>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include <nendo/base/files.hpp>
#include <nendo/base/units.hpp>

#include "cli/cli.hpp"
#include "cli/output_place.hpp"
#include "markers/bracelet_pose.hpp"
#include "markers/pose_sender.hpp"
#include "markers/sheet.hpp"
#include "markers/sheet_calibration.hpp"
#include "markers/video.hpp"

namespace nendo::markers {
namespace {

struct PrintOptions {
  std::string out;
};

struct CameraOptions {
  std::string camera = "0";
  std::uint32_t width_px = 1280;
  std::uint32_t height_px = 720;
};

struct CalibrateOptions {
  CameraOptions camera;
  std::string out = "camera.toml";
  std::uint32_t views = 20;
};

struct TrackOptions {
  CameraOptions camera;
  std::string calibration;
  std::string to = "127.0.0.1:9000";
  std::string side;
};

constexpr std::chrono::seconds report_interval{5};

Result<void> print_sheet(const PrintOptions& options) {
  if (const auto place = cli::check_place("--out", options.out, {".svg"}); !place)
    return place.error();
  if (const auto written = replace_file(options.out, draw_sheet()); !written)
    return written.error();
  std::cout << "wrote " << options.out << '\n';
  return {};
}

Error went_away(const CameraOptions& options) {
  return {Errc::no_device, "--camera " + options.camera + ": no picture came; is it plugged in?"};
}

Result<void> calibrate(const CalibrateOptions& options) {
  if (const auto place = cli::check_place("--out", options.out, {".toml"}); !place)
    return place.error();
  if (options.views < 8 || options.views > 200)
    return Error{Errc::usage, "--views must be a number from 8 to 200"};
  auto video =
      Video::open(options.camera.camera, options.camera.width_px, options.camera.height_px);
  if (!video) return video.error();
  cv::Mat picture;
  if (!video->read(picture)) return went_away(options.camera);
  const MarkerDetector detector;
  SheetCalibration calibration(picture.cols, picture.rows);
  const std::size_t wanted = options.views;
  cli::note("hold the sheet flat and still, near and far, tilted in all directions: " +
            std::to_string(wanted) + " views are taken");
  do {
    if (calibration.offer(detector.find(picture)))
      cli::note("view " + std::to_string(calibration.views()) + " of " + std::to_string(wanted));
  } while (calibration.views() < wanted && !cli::stop_requested() && video->read(picture));
  const auto camera = calibration.solve();
  if (!camera) return camera.error();
  if (const auto written = replace_file(options.out, to_toml(*camera)); !written)
    return written.error();
  std::cout << "wrote " << options.out << "; the corners fit to "
            << std::to_string(camera->error_px).substr(0, 4) << " pixels\n";
  return {};
}

Result<CameraModel> camera_of(const TrackOptions& options, const cv::Mat& picture) {
  if (options.calibration.empty()) {
    cli::note("without --calibration, a view of 60 degrees is assumed, and distances may be off by "
              "a third; see nendo-markers calibrate");
    return assumed_camera(picture.cols, picture.rows);
  }
  const auto camera = read_camera(options.calibration);
  return camera ? scaled_to(*camera, picture.cols, picture.rows) : camera;
}

/// One side's bracelet, from picture to picture.
class TrackedSide {
public:
  explicit TrackedSide(Side side) noexcept : side_(side) {}

  void look(std::span<const Marker> markers, const CameraModel& camera, const Video& video,
            const PoseSender& sender) {
    // An older pose says nothing of which of two is the right one.
    constexpr std::chrono::milliseconds max_age{300};
    if (video.time() - last_seen_ > max_age) last_.reset();
    const auto pose = find_bracelet(side_, markers, camera, last_);
    if (!pose) return;
    last_ = pose;
    last_seen_ = video.time();
    ++poses_;
    sender.send(pose_packet(side_, to_stage(*pose), video.time()));
  }
  std::string summary() const {
    return std::string(name_of(side_)) + " in " + std::to_string(poses_);
  }

private:
  Side side_;
  std::optional<BraceletPose> last_;
  std::chrono::system_clock::time_point last_seen_;
  std::size_t poses_ = 0;
};

Result<void> track(const TrackOptions& options) {
  const auto sender = PoseSender::open(options.to);
  if (!sender) return sender.error();
  auto video =
      Video::open(options.camera.camera, options.camera.width_px, options.camera.height_px);
  if (!video) return video.error();
  cv::Mat picture;
  if (!video->read(picture)) return went_away(options.camera);
  const auto camera = camera_of(options, picture);
  if (!camera) return camera.error();
  const MarkerDetector detector;
  std::vector<TrackedSide> sides;
  for (const Side side : {Side::left, Side::right})
    if (options.side.empty() || options.side == name_of(side)) sides.emplace_back(side);
  std::size_t pictures = 0;
  const auto summary = [&] {
    std::string text = std::to_string(pictures) + " pictures; bracelets seen:";
    for (const TrackedSide& side : sides)
      text += (&side == sides.data() ? " " : ", ") + side.summary();
    return text;
  };
  HostTime next_report = HostClock::now() + report_interval;
  do {
    ++pictures;
    const auto markers = detector.find(picture);
    for (TrackedSide& side : sides)
      side.look(markers, *camera, *video, *sender);
    if (HostClock::now() < next_report) continue;
    cli::note(summary());
    next_report += report_interval;
  } while (!cli::stop_requested() && video->read(picture));
  std::cout << summary() << '\n';
  if (!cli::stop_requested() && !video->is_file()) return went_away(options.camera);
  return {};
}

void add_camera_options(cli::Command& command, CameraOptions& options) {
  command.add_option("--camera", options.camera, "The camera's number, or a video file");
  command.add_option("--width", options.width_px, "Wanted width of its pictures, in pixels");
  command.add_option("--height", options.height_px, "Wanted height of its pictures, in pixels");
}

} // namespace

void add_commands(cli::Command& program) {
  auto print = program.add_command("print", "Draw the bracelets of both wrists, to print");
  auto& print_options = print.on_chosen<PrintOptions>(print_sheet);
  print.add_option("--out", print_options.out, "The drawing (.svg)").required();

  auto calibration =
      program.add_command("calibrate", "Calibrate the camera, by views of the printed sheet");
  auto& calibrate_options = calibration.on_chosen<CalibrateOptions>(calibrate);
  add_camera_options(calibration, calibrate_options.camera);
  calibration.add_option("--out", calibrate_options.out, "The calibration (.toml)");
  calibration.add_option("--views", calibrate_options.views, "The number of views");

  auto tracking = program.add_command(
      "track", "Track the bracelets, and send their poses by OSC (the default)");
  auto& track_options = tracking.on_chosen<TrackOptions>(track);
  add_camera_options(tracking, track_options.camera);
  tracking.add_option("--calibration", track_options.calibration,
                      "The camera's calibration (.toml)");
  tracking.add_option("--to", track_options.to,
                      "Where the poses go, as PORT of this machine or ADDRESS:PORT");
  tracking.add_option("--side", track_options.side, "Track one bracelet only")
      .one_of({"left", "right"});
}

} // namespace nendo::markers
