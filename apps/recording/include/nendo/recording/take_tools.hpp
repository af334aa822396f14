#pragma once
// What may be asked of a recording without a loop: what is in it, whether it is whole, and to have
// what is whole, or a part of it, as a new file, which is there only if it is complete. All of
// these block for as long as the disk does.

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include <nendo/recording/take_reader.hpp>

namespace nendo::recording {

struct GloveSummary {
  std::uint64_t samples = 0;
  std::uint64_t lost = 0;         ///< that its sequence numbers tell of
  std::uint64_t out_of_order = 0; ///< sequence numbers that did not grow
  HostTime first{};
  HostTime last{};
  HostClock::duration longest_pause{}; ///< between two samples

  double rate_hz() const noexcept; ///< 0 of less than two samples
};

struct TakeSummary {
  Setup setup;
  std::vector<GloveSummary> gloves; ///< by their numbers
  std::array<std::uint64_t, flow::requests.size()> requests{};
  std::uint64_t wrist_moves = 0;
  std::uint64_t shapes = 0;
  std::uint64_t ticks = 0;
  std::uint64_t missed = 0; ///< deadlines between ticks
  std::uint64_t ticks_out_of_order = 0;
  std::uint64_t gaps = 0;
  std::uint64_t missing = 0; ///< entries that the gaps know of
  std::optional<Ending> ending;
  HostTime last{}; ///< of any entry
  std::uint64_t bytes = 0;
  std::uint64_t good_end = 0; ///< where the last whole chunk ends
  std::uint64_t damage_count = 0;
  std::vector<driver::ChunkDamage> damages; ///< the first of them
  std::uint64_t strange = 0;                ///< TakeReader::strange()
  bool counts_agree = true; ///< those of the ending and what there is, where nothing is missing

  HostClock::duration duration() const noexcept;
  /// No damage, and nothing that a recorder would not write; it may have been cut off.
  bool is_whole() const noexcept;
};

/// Error: bad_input, as TakeReader::open().
Result<TakeSummary> summarise(const std::filesystem::path& path);
/// As TakeReader::of().
Result<TakeSummary> summarise(std::span<const std::byte> bytes, std::string_view name);

/// What was written.
struct NewTake {
  std::uint64_t bytes = 0;
  std::uint64_t entries = 0; ///< of cut_take() and add_shapes()
  std::uint64_t shapes = 0;  ///< of add_shapes()
  std::uint64_t chunks = 0;  ///< of repair_take()
  std::uint64_t damages = 0; ///< of repair_take(): places that are gaps now
};

/// All whole chunks, numbered anew, as a new file; a gap stands for each damage. Errors: bad_input
/// (nothing in it is whole), failed (the new file is there already, or cannot be written).
Result<NewTake> repair_take(const std::filesystem::path& from, const std::filesystem::path& to);

/// What happened from `begin` to before `end`, counted from the recording's beginning, as a new
/// file; whole ticks of a loop. Unless it begins with the recording, a gap comes first: the shape
/// at its beginning is not in it. Errors: as repair_take(); bad_input if nothing happened then.
Result<NewTake> cut_take(const std::filesystem::path& from, const std::filesystem::path& to,
                         HostClock::duration begin, HostClock::duration end);

/// The same with so many shapes a second, each of a whole tick, the first one's always: replays the
/// loop over `model`, which ought to be the recorded one. Shapes that it has are left out. Errors:
/// as repair_take() and LoopReplay::make(); bad_input (too many vertices).
Result<NewTake> add_shapes(const std::filesystem::path& from, const std::filesystem::path& to,
                           const deform::Mesh& model, double rate_hz);

} // namespace nendo::recording
