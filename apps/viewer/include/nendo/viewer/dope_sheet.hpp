#pragma once
// Times along a strip, and what of it the pointer is at. No drawing, no window: numbers in, numbers
// out. Pixels count from the strip's top left corner.

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
  std::vector<double> keys_s; ///< rising
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

/// Which part of a timeline is seen, and where. From the top: a ruler, the lanes, the marks.
class DopeSheet {
public:
  static constexpr double left = 58.0;    ///< names stand there
  static constexpr double right = 14.0;   ///< room for half a key
  static constexpr double ruler = 24.0;   ///< height
  static constexpr double lane = 26.0;    ///< height
  static constexpr double reach = 8.0;    ///< a pointer so near to a key or a mark is at it
  static constexpr double closest = 0.02; ///< of seconds, seen all over

  static double height_for(std::size_t lanes) noexcept {
    return ruler + lane * static_cast<double>(lanes + 1);
  }

  /// The strip's width, and how long the timeline is now; keeps what is seen, within it.
  void fit(double width, double duration_s) noexcept;
  double first_s() const noexcept { return first_s_; } ///< seen
  double last_s() const noexcept { return last_s_; }   ///< seen
  double x_of(double time_s) const noexcept;
  /// Within 0 and the duration, wherever x is.
  double time_at(double x) const noexcept;
  /// Of a lane's keys, or with as many as there are lanes, of the marks.
  static double middle_of(std::size_t lane) noexcept;

  /// The time under x stays there; forward is closer.
  void zoom(double x, double steps) noexcept;
  void pan(double dx) noexcept;
  /// What is seen follows a play head that left it.
  void follow(double time_s) noexcept;

  /// The key at the pointer, or the nearest of several.
  std::optional<StripKey> key_at(std::span<const StripLane> lanes, double x, double y) const;
  /// Likewise, among the marks.
  std::optional<std::size_t> mark_at(std::span<const StripMark> marks, std::size_t lanes, double x,
                                     double y) const;
  /// Between the ruler's numbers: 1, 2 or 5 times a power of ten, so that they have room.
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
