#pragma once
// A wire that hands draw through the model, like a potter's wire. When completed, it cuts the
// model.

#include <array>
#include <cstdint>
#include <span>

#include <nendo/deform/cut.hpp>

namespace nendo::flow {

/// The sequence of a wire's end positions, in model units. Has a fixed size and does not allocate.
/// When it is full, every second place is dropped; short movements back and forth are also dropped.
class NENDO_API WirePath {
public:
  static constexpr std::size_t max_places = 128;

  /// Begins a wire. Places closer than `step`, or than 1/40 of the wire's max length, are merged.
  void begin(double step) noexcept;
  /// Does nothing unless the wire is being drawn. Ignores places that are not finite.
  void draw_to(const deform::WirePlace& place) noexcept;
  void end() noexcept;   ///< completes the wire, if it has places, and smooths its path
  void clear() noexcept; ///< removes the wire

  bool is_drawing() const noexcept { return is_drawing_; }
  /// Returns the number of completed wires, by which a reader detects a new one.
  std::uint32_t completed() const noexcept { return completed_; }
  /// Returns the places of the current or last wire.
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
  std::uint64_t version_ = 0; ///< changes with every change
  double step_ = 0.0;
  deform::WirePlace last_{}; ///< may not be in places_
  bool is_drawing_ = false;
};

} // namespace nendo::flow
