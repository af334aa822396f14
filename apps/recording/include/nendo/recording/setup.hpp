#pragma once
// The beginning of a recording: who recorded it, when and with what, and all data from which the
// loop is made, so that a loop that does the same can be made again.

#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <nendo/driver/glove.hpp>
#include <nendo/flow/deform_loop.hpp>
#include <nendo/recording/chunk_file.hpp>

namespace nendo::recording {

/// Identifies a model by its number of vertices and the CRC-32C of their coordinates, which are x y
/// z of one vertex after another as little-endian doubles.
struct ShapeSum {
  std::uint64_t vertices = 0;
  std::uint32_t crc = 0;
  friend bool operator==(const ShapeSum&, const ShapeSum&) = default;
};
NENDO_API ShapeSum sum_of(const deform::Points& vertices) noexcept;

struct RecordedPuppet {
  std::string text{};      ///< its file's text
  deform::Points starts{}; ///< puppet::Rig::starts()
};
/// Makes the puppet again, for the model of the recording. Error: bad_input.
NENDO_API Result<std::shared_ptr<const puppet::Rig>> rig_of(const RecordedPuppet& recorded,
                                                            const deform::Mesh& model);

struct LoopSetup {
  std::string mesh; ///< the file's name, as it was given
  ShapeSum mesh_sum;
  flow::Placement placement; ///< without the gaps
  /// Has no pointers and no stages, and not `spin`, `longest_wait` and `evaluation.threads`,
  /// because the shape does not depend on them.
  flow::LoopOptions options;
  /// The vector instructions with which the field was evaluated. Others may round differently.
  std::string simd;
  /// How the model came from the file's before the recording began (flow::rebuild()).
  std::vector<std::shared_ptr<const flow::ModelOrigin>> origins{};
  /// The shape at first, in the blocks of the model's layout; empty: the model.
  std::vector<deform::VertexBlock> rest{};
  RecordedPuppet puppet{}; ///< without a text: the hands touch the model
};

struct Setup {
  std::chrono::sys_time<std::chrono::nanoseconds> begun; ///< the system clock's time
  HostTime begun_host{};                                 ///< the same moment by HostClock
  std::string program;                   ///< the program that recorded it, such as "nendo 0.2.0"
  std::string wearer;                    ///< empty means unknown
  std::vector<driver::GloveInfo> gloves; ///< indexed by their numbers
  /// By the numbers of their gloves, also if there is no loop. They have no rings and no measured
  /// bones.
  std::vector<flow::HandInput> hands;
  std::optional<LoopSetup> loop; ///< nothing if only gloves were recorded
};

/// Returns a setup that begins now.
NENDO_API Setup begin_setup(std::string program);

/// Makes of a loop's setup, as it began, the one of a loop that continues from a later state.
/// `layout` is the loop's.
NENDO_API void continue_from(const flow::LoopState& state, const deform::BlockLayout& layout,
                             Setup& setup);

/// Returns the file's header and the chunks of a setup, numbered from 0, and sets `chunks` to the
/// number of these chunks.
NENDO_API std::vector<std::byte> setup_bytes(const Setup& setup, std::uint32_t& chunks);

/// Returns whether setup_bytes() of a setup can be read again. Error: failed, with what is out of
/// its range, and what to do. A recorder refuses such a setup before anything is recorded.
NENDO_API Result<void> check_readable(const Setup& setup, std::span<const std::byte> bytes);

/// Reads a chunk into `setup`. Returns false if the chunk is of a setup, but holds something that
/// nendo does not write. Chunks of other types are ignored and give true. The result is finite and
/// usable without further checks, because enumerators, counts and sizes are checked here.
NENDO_API bool read_setup_chunk(ChunkType type, std::span<const std::byte> payload, Setup& setup);

} // namespace nendo::recording
