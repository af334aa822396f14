#pragma once
// Tools for recordings that need no live loop: a summary, a check whether the recording is whole,
// and new recordings from the whole parts, or from a part, of another. A new file exists only if it
// is complete. All functions block as long as the disk does.

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include <nendo/recording/take_reader.hpp>

namespace nendo::recording {

struct NENDO_API GloveSummary {
  std::uint64_t samples = 0;
  /// Samples that are not in the file, though their records were delivered: gaps in the sequence
  /// numbers.
  std::uint64_t lost = 0;
  std::uint64_t out_of_order = 0; ///< sequence numbers that did not increase
  HostTime first{};
  HostTime last{};
  HostClock::duration longest_pause{};      ///< between two samples
  std::optional<driver::RecordCounts> sent; ///< nullopt: not counted
  std::uint64_t punches = 0;                ///< how often a layer came in or went out

  double rate_hz() const noexcept; ///< 0 if there are less than two samples
};

struct NENDO_API TakeSummary {
  Setup setup;
  std::vector<GloveSummary> gloves; ///< indexed by their numbers
  std::array<std::uint64_t, flow::requests.size()> requests{};
  std::uint64_t wrist_moves = 0;
  std::uint64_t poses = 0; ///< the poses of trackers
  std::uint64_t settings_changes = 0;
  std::uint64_t model_changes = 0;        ///< also undos and redos of them
  std::uint64_t puppet_changes = 0;       ///< also undos and redos of them
  std::vector<HostClock::duration> marks; ///< times of flow::Mark, since the beginning
  std::uint64_t shapes = 0;
  std::uint64_t ticks = 0;
  std::uint64_t missed = 0; ///< deadlines between ticks
  std::uint64_t ticks_out_of_order = 0;
  std::uint64_t gaps = 0;
  std::uint64_t missing = 0; ///< entries that the gaps count
  std::optional<Ending> ending;
  HostTime last{}; ///< the last entry's time
  std::uint64_t bytes = 0;
  std::uint64_t good_end = 0; ///< where the last whole chunk ends
  std::uint64_t damage_count = 0;
  std::vector<ChunkDamage> damages;  ///< the first ones
  std::uint64_t unknown_entries = 0; ///< TakeReader::unknown_entries()
  bool counts_agree = true; ///< the counts of the ending match the entries, unless some are missing

  HostClock::duration duration() const noexcept;
  /// Returns true if there is no damage and no content that a recorder would not write. The
  /// recording may still have been cut off.
  bool is_whole() const noexcept;
};

/// Reads a recording and summarises it. Errors: those of TakeReader::open().
NENDO_API Result<TakeSummary> summarise(const std::filesystem::path& path);
/// Does the same for a recording in memory. Errors: those of TakeReader::of().
NENDO_API Result<TakeSummary> summarise(std::span<const std::byte> bytes, std::string_view name);

/// Counts of the data that were written to a new file.
struct NewTake {
  std::uint64_t bytes = 0;
  std::uint64_t entries = 0; ///< entries that cut_take() or add_shapes() wrote
  std::uint64_t shapes = 0;  ///< shapes that add_shapes() wrote
  std::uint64_t chunks = 0;  ///< chunks that repair_take() wrote
  std::uint64_t damages = 0; ///< damaged sections that are gaps now
};

/// Writes all whole chunks to a new file, with new numbers. A gap replaces each damaged section.
/// Errors: bad_input (nothing is whole), failed (the new file exists already or cannot be written).
NENDO_API Result<NewTake> repair_take(const std::filesystem::path& from,
                                      const std::filesystem::path& to);

/// Writes the entries from `begin` to before `end` to a new file, in whole ticks of a loop. Both
/// times count from the beginning of the recording. If the part does not begin with the recording,
/// it begins with a gap, because the shape at that moment is not in it, and then with the settings
/// of that moment. Errors: those of repair_take(), and bad_input if there are no entries in this
/// interval.
NENDO_API Result<NewTake> cut_take(const std::filesystem::path& from,
                                   const std::filesystem::path& to, HostClock::duration begin,
                                   HostClock::duration end);

/// Writes a new file with all entries and with `rate_hz` shapes a second. To make them, it replays
/// the loop over `model`, which should be the recorded one. Each shape belongs to a whole tick, and
/// the first tick has one. Shapes that the recording already has are left out. Errors: those of
/// repair_take() and LoopReplay::make(), and bad_input (too many vertices).
NENDO_API Result<NewTake> add_shapes(const std::filesystem::path& from,
                                     const std::filesystem::path& to, const deform::Mesh& model,
                                     double rate_hz);

} // namespace nendo::recording
