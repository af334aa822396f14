#pragma once
// Finds markers in pictures, by OpenCV's ArUco. Only its source knows that ArUco moved from
// opencv_contrib into the main modules with OpenCV 4.7, with another interface.

#include <array>
#include <memory>
#include <vector>

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>

namespace nendo::markers {

/// A marker has this number of cells in each direction, inside a black border of one cell.
inline constexpr int cells = 4;

struct Marker {
  int number = 0;
  std::array<cv::Point2f, 4> corners; ///< clockwise from the marker's upper left
};

/// One thread at a time.
class MarkerDetector {
public:
  MarkerDetector();
  ~MarkerDetector();
  MarkerDetector(const MarkerDetector&) = delete;
  MarkerDetector& operator=(const MarkerDetector&) = delete;

  /// Returns the markers in a grey picture of 8 bits, in any order.
  std::vector<Marker> find(const cv::Mat& picture) const;

private:
  struct Settings;
  std::unique_ptr<Settings> settings_;
};

/// Returns the cells of a marker, row by row; true: white. `number` is below 50.
std::array<std::array<bool, cells>, cells> marker_cells(int number);

} // namespace nendo::markers
