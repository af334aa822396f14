#include "markers/video.hpp"

#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgproc.hpp>

#include <nendo/base/number_in.hpp>

namespace nendo::markers {
namespace {

/// Opens a file by what reads files. OpenCV by itself would also look for photo cameras at USB.
bool open_file(const std::string& name, cv::VideoCapture& capture) {
  for (const auto reader : {cv::CAP_FFMPEG, cv::CAP_GSTREAMER, cv::CAP_IMAGES})
    if (capture.open(name, reader)) return true;
  return false;
}

} // namespace

Result<Video> Video::open(const std::string& source, std::uint32_t width_px,
                          std::uint32_t height_px) {
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT); // the error says it
  Video video;
  const auto number = number_in<int>(source);
  video.is_file_ = !number;
  try {
    if (!(video.is_file_ ? open_file(source, video.capture_)
                         : video.capture_.open(*number, cv::CAP_V4L2)))
      return Error{Errc::no_device, video.is_file_
                                        ? "--camera " + source +
                                              ": no video that can be read; give a file, or a "
                                              "camera's number, as 0"
                                        : "--camera " + source +
                                              ": there is no such camera, or another program "
                                              "uses it; look for /dev/video*"};
    if (!video.is_file_) {
      // Most cameras send 30 pictures of this size per second only if they compress them.
      video.capture_.set(cv::CAP_PROP_FOURCC, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'));
      video.capture_.set(cv::CAP_PROP_FRAME_WIDTH, width_px);
      video.capture_.set(cv::CAP_PROP_FRAME_HEIGHT, height_px);
      video.capture_.set(cv::CAP_PROP_BUFFERSIZE, 1); // an old picture is worse than none
    }
  } catch (const cv::Exception& error) {
    return Error{Errc::no_device, "--camera " + source + ": " + error.err};
  }
  return video;
}

bool Video::read(cv::Mat& picture) {
  try {
    if (!capture_.grab()) return false;
    time_ = std::chrono::system_clock::now();
    if (!capture_.retrieve(colours_) || colours_.empty()) return false;
    if (colours_.channels() == 1) {
      picture = colours_;
    } else {
      cv::cvtColor(colours_, picture, cv::COLOR_BGR2GRAY);
    }
    return picture.depth() == CV_8U;
  } catch (const cv::Exception&) {
    return false;
  }
}

} // namespace nendo::markers
