#pragma once
// The pose of a hand between its keys.

#include <array>
#include <vector>

#include "timeline/timeline.hpp"

namespace nendo::timeline {

/// Joint angles and the wrist's place follow piecewise cubics of continuous slope that stay between
/// the keys' values (Fritsch and Carlson 1980; the slopes are the harmonic means of Fritsch and
/// Butland 1984). So no joint leaves its limits, and a joint with equal values at two keys does not
/// move between them. The wrist turns at a constant speed from key to key.
class HandCurve {
public:
  /// `keys` must fulfil the conditions of HandTrack::keys.
  explicit HandCurve(std::vector<Key> keys);

  /// Returns the pose at that time. At the time of a key it is that key, bit for bit. Before the
  /// first key it is the first one, and after the last key it is the last one. Any thread may call
  /// it.
  Key at(double time_s) const noexcept;
  const std::vector<Key>& keys() const noexcept { return keys_; }

private:
  static constexpr std::size_t channel_count = hand::angle_count + 3;
  using Channels = std::array<double, channel_count>;

  static double& channel(Key& key, std::size_t at) noexcept;
  static double channel(const Key& key, std::size_t at) noexcept;
  double secant(std::size_t interval, std::size_t at) const noexcept;
  double slope(std::size_t key, std::size_t at) const noexcept;

  std::vector<Key> keys_;
  std::vector<Channels> slopes_; ///< per second, at the keys
};

} // namespace nendo::timeline
