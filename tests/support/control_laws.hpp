#pragma once
// What holds for the controls of every window.

#include <cstddef>
#include <vector>

#include <doctest/doctest.h>

#include "viewer/controls.hpp"

namespace nendo::test {

/// Checks that no two controls of the current picture overlap, and that no text is cut.
inline void check_controls() {
  const auto shown = viewer::controls();
  CHECK(shown.size() > 12);
  for (std::size_t at = 0; at < shown.size(); ++at) {
    CAPTURE(shown[at].name);
    CHECK_FALSE(shown[at].is_cut);
    for (std::size_t other = 0; other < at; ++other) {
      const Eigen::Vector2f overlap =
          shown[at].max.cwiseMin(shown[other].max) - shown[at].min.cwiseMax(shown[other].min);
      CHECK_MESSAGE(overlap.minCoeff() <= 0.0F, shown[other].name);
    }
  }
}

/// Checks that each control of the current picture has a tooltip. point(pixel) shows pictures with
/// the pointer there.
template <class Point>
void check_tooltips(const Point& point) {
  const std::vector<viewer::Control> all(viewer::controls().begin(), viewer::controls().end());
  for (const viewer::Control& control : all) {
    if (control.name == "dope sheet") continue; // it explains its keys and marks
    CAPTURE(control.name);
    point(((control.min + control.max) / 2.0F).cast<double>());
    CHECK(viewer::tooltip().size() > 10);
  }
}

} // namespace nendo::test
