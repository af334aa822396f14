#pragma once
// The wire or knife that hands draw through the model.

#include <nendo/flow/command.hpp>
#include <nendo/flow/wire_path.hpp>
#include <nendo/puppet/rig.hpp>

namespace nendo::flow {

/// For the thread that ticks. It does not allocate.
class DrawnBlade {
public:
  using Hands = puppet::RigPlayer::Hands;

  explicit DrawnBlade(double units_per_metre) noexcept : units_per_metre_(units_per_metre) {}

  void begin(Blade blade) noexcept;
  void end() noexcept;
  void clear() noexcept { path_.clear(); }
  /// Moves the blade with the hands, on the stage, while it is drawn. A knife is `knife_m` long. A
  /// wire is between both index fingertips, or between thumb and index finger of the only hand. A
  /// knife is held by the hand that points more when its path begins.
  void follow(const Hands& hands, double knife_m) noexcept;

  bool is_drawing() const noexcept { return path_.is_drawing(); }
  const WirePath& path() const noexcept { return path_; } ///< of the present blade, or the last
  const WirePath& completed() const noexcept { return completed_; } ///< the last complete path

private:
  double units_per_metre_;
  WirePath path_;
  WirePath completed_;
  Blade blade_ = Blade::wire;
  bool knife_in_right_ = true; ///< hand
};

} // namespace nendo::flow
