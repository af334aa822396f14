#pragma once
// What changes of settings cost a running loop: the radius of all fingers changes in every other
// second, and the ticks of both kinds of seconds are counted apart. So they are of one run, and
// whatever else the machine does is in both.

#include <array>
#include <cstdint>

#include <nendo/flow/deform_loop.hpp>

namespace nendo::stress {

/// The ticks of the seconds without changes, or of those with them.
struct ChangeTally {
  std::uint64_t ticks = 0;
  std::uint64_t missed = 0; ///< deadlines before these ticks
  flow::Histogram lateness;
  flow::Histogram work;
};

/// By whether there were changes: without, with.
using ChangeTallies = std::array<ChangeTally, 2>;

/// Returns whether the settings change in the second of that time of a run.
bool changes_at(HostTime start, HostTime time) noexcept;

void count(const flow::TickRecord& record, HostTime start, ChangeTallies& tallies) noexcept;

class SettingsChanger {
public:
  /// Asks for so many changes a minute, in the seconds that have any; 0: for none.
  explicit SettingsChanger(double per_minute) noexcept : per_minute_(per_minute) {}
  /// Asks for those that are due. To be called some hundred times a second, not by the loop's
  /// thread.
  void update(flow::DeformLoop& loop, HostTime start);

private:
  double per_minute_;
  std::uint64_t asked_ = 0;
  HostTime next_{};
};

} // namespace nendo::stress
