#pragma once
// Finds the ends of one sensor's swings: the counts at which its joint reverses. A hand at rest has
// none, and an excursion counts once, at any size and duration.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include <nendo/base/api.hpp>

namespace nendo::hand {

class NENDO_API SwingFinder {
public:
  struct End {
    double counts = 0.0;
    double amplitude = 0.0; ///< size of the swing that ends here, counts
    bool is_top = false;
  };

  /// Takes the next count in time order, and returns the end that it reveals, if any. Ignores
  /// spikes of at most two samples, and movements of less than `min_swing` counts. The first turn
  /// is no end, because the start of its swing is unknown. Wait-free, no allocation.
  std::optional<End> push(std::uint16_t count, double min_swing) noexcept;
  /// Discards the previous counts, as after a pause.
  void reset() noexcept { seen_ = 0; }

private:
  static constexpr std::size_t window = 5; ///< window of the median that removes spikes

  std::optional<double> median(std::uint16_t count) noexcept;

  std::array<std::uint16_t, window> recent_{};
  std::size_t seen_ = 0;            ///< number of counts since the last reset
  double bottom_ = 0.0, top_ = 0.0; ///< the current swing, counts
  bool rises_ = false, falls_ = false;
};

} // namespace nendo::hand
