#include "markers/marker_detector.hpp"

#include <algorithm>
#include <cstddef>

#include <opencv2/core/version.hpp>

#define NENDO_ARUCO_IN_OBJDETECT                                                                   \
  (CV_VERSION_MAJOR > 4 || (CV_VERSION_MAJOR == 4 && CV_VERSION_MINOR >= 7))

#if NENDO_ARUCO_IN_OBJDETECT
#include <opencv2/objdetect/aruco_detector.hpp>
#else
#include <opencv2/aruco.hpp>
#endif

namespace nendo::markers {
namespace {

// Cells of 4x4 are the largest, and so are seen from farthest.
constexpr auto dictionary_name = cv::aruco::DICT_4X4_50;

void set_parameters(cv::aruco::DetectorParameters& parameters) {
  // With the default of 5 pixels, the refinement finds the corner of the next cell if the marker is
  // far: at 0.8 m, errors are 14 to 47 mm and up to 9 degrees.
  parameters.cornerRefinementWinSize = 2;
  // Two windows of the threshold, for far and near markers. Each costs 9 ms of 1280 x 720 pixels,
  // and the default's third one finds no more.
  parameters.adaptiveThreshWinSizeMin = 7;
  parameters.adaptiveThreshWinSizeMax = 23;
  parameters.adaptiveThreshWinSizeStep = 16;
  // A side of the smallest marker that is looked for: 1.2 % of the picture's width, 15 of 1280.
  parameters.minMarkerPerimeterRate = 0.048;
#if NENDO_ARUCO_IN_OBJDETECT
  parameters.cornerRefinementMethod = static_cast<int>(cv::aruco::CORNER_REFINE_SUBPIX);
#else
  parameters.cornerRefinementMethod = cv::aruco::CORNER_REFINE_SUBPIX;
#endif
}

} // namespace

#if NENDO_ARUCO_IN_OBJDETECT

struct MarkerDetector::Settings {
  cv::aruco::ArucoDetector detector;
};

MarkerDetector::MarkerDetector() : settings_(std::make_unique<Settings>()) {
  cv::aruco::DetectorParameters parameters;
  set_parameters(parameters);
  settings_->detector =
      cv::aruco::ArucoDetector(cv::aruco::getPredefinedDictionary(dictionary_name), parameters);
}

#else

struct MarkerDetector::Settings {
  cv::Ptr<cv::aruco::Dictionary> dictionary = cv::aruco::getPredefinedDictionary(dictionary_name);
  cv::Ptr<cv::aruco::DetectorParameters> parameters = cv::aruco::DetectorParameters::create();
};

MarkerDetector::MarkerDetector() : settings_(std::make_unique<Settings>()) {
  set_parameters(*settings_->parameters);
}

#endif

MarkerDetector::~MarkerDetector() = default;

std::vector<Marker> MarkerDetector::find(const cv::Mat& picture) const {
  std::vector<std::vector<cv::Point2f>> corners;
  std::vector<int> numbers;
#if NENDO_ARUCO_IN_OBJDETECT
  settings_->detector.detectMarkers(picture, corners, numbers);
#else
  cv::aruco::detectMarkers(picture, settings_->dictionary, corners, numbers, settings_->parameters);
#endif
  std::vector<Marker> markers(numbers.size());
  for (std::size_t at = 0; at < markers.size(); ++at) {
    markers[at].number = numbers[at];
    std::copy_n(corners[at].begin(), 4, markers[at].corners.begin());
  }
  return markers;
}

std::array<std::array<bool, cells>, cells> marker_cells(int number) {
  const auto dictionary = cv::aruco::getPredefinedDictionary(dictionary_name);
#if NENDO_ARUCO_IN_OBJDETECT
  const cv::Mat bytes = dictionary.bytesList.row(number);
#else
  const cv::Mat bytes = dictionary->bytesList.row(number);
#endif
  const cv::Mat bits = cv::aruco::Dictionary::getBitsFromByteList(bytes, cells);
  std::array<std::array<bool, cells>, cells> whites{};
  for (int row = 0; row < cells; ++row)
    for (int column = 0; column < cells; ++column)
      whites[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)] =
          bits.at<unsigned char>(row, column) != 0;
  return whites;
}

} // namespace nendo::markers
