#pragma once
// Finds the ends of the swings of one sensor: the counts from which its joint comes back. A hand at
// rest has none, however long it rests, and an excursion counts once, however far and long it is.

#include <array>
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

  /// Takes the next count in time, and returns the end that it shows, if any. A count that is gone
  /// again within two samples is not seen. A movement over less than `min_swing` counts is no
  /// swing. Where the first count lies in its swing is not known, so that the first turn is no end.
  /// Wait-free, no allocation.
  std::optional<End> push(std::uint16_t count, double min_swing) noexcept;
  /// Forgets what came before, as after a pause.
  void reset() noexcept { seen_ = 0; }

private:
  static constexpr std::size_t window = 5; ///< window of the median that removes spikes

  std::optional<double> median(std::uint16_t count) noexcept;

  std::array<std::uint16_t, window> recent_{};
  std::size_t seen_ = 0;            ///< number of counts since the last reset
  double bottom_ = 0.0, top_ = 0.0; ///< the swing under way, counts
  bool rises_ = false, falls_ = false;
};

} // namespace nendo::hand
