#pragma once
// The geometry of a strip that shows a timeline: which time is at which pixel, and which key or
// mark the pointer is at. It draws nothing and knows no window. Pixels count from the strip's top
// left corner.

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <nendo/driver/sample.hpp>

namespace nendo::viewer {

/// A hand's keys.
struct StripLane {
  Side side = Side::right;
  std::vector<double> keys_s; ///< in rising order
};

struct StripMark {
  double time_s = 0.0;
  std::string name;
};

struct StripKey {
  std::size_t lane = 0;
  std::size_t key = 0;
  friend bool operator==(const StripKey&, const StripKey&) = default;
};

/// The visible part of a timeline and its place on the strip. From top to bottom, the strip has a
/// ruler, the lanes and the marks.
class DopeSheet {
public:
  static constexpr double left = 58.0;    ///< pixels for the names
  static constexpr double right = 14.0;   ///< pixels, enough for half a key
  static constexpr double ruler = 24.0;   ///< height
  static constexpr double lane = 26.0;    ///< height
  static constexpr double reach = 8.0;    ///< pixels from the pointer to a key or mark
  static constexpr double closest = 0.02; ///< seconds; the shortest part that can fill the strip

  static double height_for(std::size_t lanes) noexcept {
    return ruler + lane * static_cast<double>(lanes + 1);
  }

  /// Sets the strip's width in pixels and the timeline's duration. The visible part stays the same
  /// as far as it is within the duration. If all was visible, all stays visible.
  void fit(double width, double duration_s) noexcept;
  double first_s() const noexcept { return first_s_; } ///< the begin of the visible part
  double last_s() const noexcept { return last_s_; }   ///< its end
  double x_of(double time_s) const noexcept;
  /// Returns the time at x, limited to 0 and the duration.
  double time_at(double x) const noexcept;
  /// Returns the y of the middle of that lane. The number of lanes as `lane` gives the row of the
  /// marks.
  static double middle_of(std::size_t lane) noexcept;

  /// Zooms while the time under x stays there. Positive steps come closer.
  void zoom(double x, double steps) noexcept;
  void pan(double dx) noexcept;
  /// Moves the visible part so that it contains time_s, if it does not.
  void follow(double time_s) noexcept;

  /// Returns the key at the pointer, or the nearest if there are several.
  std::optional<StripKey> key_at(std::span<const StripLane> lanes, double x, double y) const;
  /// Returns the mark at the pointer, or the nearest if there are several.
  std::optional<std::size_t> mark_at(std::span<const StripMark> marks, std::size_t lanes, double x,
                                     double y) const;
  /// Returns the interval between the ruler's numbers: 1, 2 or 5 times a power of ten, so that the
  /// numbers do not overlap.
  double ruler_step_s() const noexcept;

private:
  void show(double first_s, double last_s) noexcept;
  double span_px() const noexcept;

  double width_ = 400.0;
  double duration_s_ = 0.0;
  double first_s_ = 0.0;
  double last_s_ = 1.0;
};

} // namespace nendo::viewer
