#pragma once
// The settings that a user is choosing, with keys or with widgets. The window and the terminal
// share it; the browser's page does the same.

#include <array>
#include <optional>

#include <nendo/base/units.hpp>
#include <nendo/flow/command.hpp>

namespace nendo::flow {

/// Shows the requested settings until a loop has had time to take them, and then those in effect,
/// the caller has requested it. Asking thread; does not allocate.
class NENDO_API WantedSettings {
public:
  static constexpr std::array kernels{deform::Wendland::c0, deform::Wendland::c2,
                                      deform::Wendland::c4, deform::Wendland::c6};
  static constexpr HostClock::duration patience = std::chrono::seconds(1);

  LoopSettings now; ///< the chosen settings; widgets write here

  /// To be called with each frame's settings. Returns true if other settings are chosen by that.
  bool follow(const LoopSettings& in_effect) noexcept;
  /// Returns the command for the chosen settings, if they were not requested yet.
  std::optional<Command> ask() noexcept;

  /// The points of a puppet do not press clay.
  void next_mode(bool is_puppet) noexcept;
  void next_kernel() noexcept;
  /// Gives all fingers the next brush, none left out; brushes are of type 2.
  void next_brush() noexcept;
  /// A quarter more of clay; from 1 to 0.
  void next_volume() noexcept;
  void toggle_hold() noexcept { now.hold = now.hold == Hold::hand ? Hold::fingertips : Hold::hand; }
  void toggle_folding() noexcept { now.injective = !now.injective; }
  void toggle_filter() noexcept {
    const bool is_off = now.filter.kind == hand::FilterKind::off;
    now.filter.kind = is_off ? hand::FilterKind::one_euro : hand::FilterKind::off;
  }
  /// Make all radii larger, or smaller, by a tenth, within the range.
  void enlarge_radii() noexcept { scale_radii(1.1); }
  void reduce_radii() noexcept { scale_radii(1.0 / 1.1); }
  bool has_one_radius() const noexcept; ///< all fingers have the same
  bool has_one_brush() const noexcept;
  /// Make the brushes stronger, or weaker and then their opposites, by a tenth of the most.
  void strengthen() noexcept { add_strength(0.1); }
  void weaken() noexcept { add_strength(-0.1); }

private:
  void scale_radii(double factor) noexcept;
  void add_strength(double more) noexcept;

  LoopSettings asked_;
  HostTime asked_at_{};
};

} // namespace nendo::flow
