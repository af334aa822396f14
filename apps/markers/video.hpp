#pragma once
// Pictures of a camera, or of a file.

#include <chrono>
#include <cstdint>
#include <string>

#include <opencv2/core/mat.hpp>
#include <opencv2/videoio.hpp>

#include <nendo/base/result.hpp>

namespace nendo::markers {

class Video {
public:
  /// Opens camera number `source`, in the size nearest to `width_px` and `height_px` that it has,
  /// or a file of this name. May block for seconds. Error: no_device.
  static Result<Video> open(const std::string& source, std::uint32_t width_px,
                            std::uint32_t height_px);

  /// Waits for the next picture, and makes it grey. Returns false at the end of the file, or if the
  /// camera went away.
  bool read(cv::Mat& picture);
  /// Returns when the last picture came: after its exposure, and after what the camera takes.
  std::chrono::system_clock::time_point time() const noexcept { return time_; }
  bool is_file() const noexcept { return is_file_; }

private:
  cv::VideoCapture capture_;
  cv::Mat colours_;
  std::chrono::system_clock::time_point time_;
  bool is_file_ = false;
};

} // namespace nendo::markers
