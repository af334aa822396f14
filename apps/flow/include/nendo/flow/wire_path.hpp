#pragma once
// A wire that hands draw through the model, as a potter cuts clay. When it has been drawn, it cuts.

#include <array>
#include <cstdint>
#include <span>

#include <nendo/deform/cut.hpp>

namespace nendo::flow {

/// The successive places of a wire's ends, in model units. It has a fixed size and does not
/// allocate. Where a wire is drawn far, every second place is forgotten; and what a hand goes back
/// and forth by a few steps is.
class NENDO_API WirePath {
public:
  static constexpr std::size_t max_places = 128;

  /// Begins another wire, of which places that are nearer to each other than `step`, or than 1/40
  /// of the wire's greatest length, are one.
  void begin(double step) noexcept;
  /// Does nothing unless the wire is being drawn. Places that are not finite are passed over.
  void draw_to(const deform::WirePlace& place) noexcept;
  void end() noexcept;   ///< the wire is drawn, if it has been anywhere; its way is smoothed
  void clear() noexcept; ///< there is no wire

  bool is_drawing() const noexcept { return is_drawing_; } ///< just now
  /// Returns how many wires have been drawn to their end. The number distinguishes a new one from
  /// one that has cut already.
  std::uint32_t completed() const noexcept { return completed_; }
  /// Returns the places of the current wire, or of the last one.
  std::span<const deform::WirePlace> places() const noexcept { return {places_.data(), count_}; }
  bool operator==(const WirePath& other) const noexcept { return version_ == other.version_; }

private:
  void thin_out() noexcept;
  void smooth() noexcept;
  bool is_near_last(const deform::WirePlace& place) const noexcept;
  void forget_detour(const deform::WirePlace& place) noexcept;

  std::array<deform::WirePlace, max_places> places_{};
  std::uint32_t count_ = 0;
  std::uint32_t completed_ = 0;
  std::uint64_t version_ = 0; ///< differs where anything does
  double step_ = 0.0;
  deform::WirePlace last_{}; ///< which may not be among the places
  bool is_drawing_ = false;
};

} // namespace nendo::flow
