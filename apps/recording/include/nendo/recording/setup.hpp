#pragma once
// The beginning of a recording: its wearer, time, program and gloves, and all data that are
// necessary to make an identical loop.

#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <nendo/driver/glove.hpp>
#include <nendo/flow/deform_loop.hpp>
#include <nendo/recording/chunk_file.hpp>
#include <nendo/recording/sample_record.hpp>

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
/// Reconstructs the puppet for the model of the recording. Error: bad_input.
NENDO_API Result<std::shared_ptr<const puppet::Rig>> rig_of(const RecordedPuppet& recorded,
                                                            const deform::Mesh& model);

struct LoopSetup {
  std::string mesh; ///< the file's name, as the user gave it
  ShapeSum mesh_sum;
  flow::Placement placement; ///< without the gaps
  /// Without pointers and stages, and without `spin`, `longest_wait` and `evaluation.threads`,
  /// because the shape does not depend on them.
  flow::LoopOptions options;
  /// The vector instructions with which the field was evaluated. Others may round differently.
  std::string simd;
  /// The changes from the file's model to the model at the beginning (flow::rebuild()).
  std::vector<std::shared_ptr<const flow::ModelOrigin>> origins{};
  /// The initial shape, in blocks of the model's layout; empty: the model's shape.
  std::vector<deform::VertexBlock> rest{};
  RecordedPuppet puppet{}; ///< empty text: no puppet, hands touch the model
  bool is_tracked = false; ///< trackers move wrists
};

struct Setup {
  std::chrono::sys_time<std::chrono::nanoseconds> begun; ///< the system clock's time
  HostTime begun_host{};                                 ///< the same moment by HostClock
  std::string program;                   ///< the program that recorded it, such as "nendo 0.2.0"
  std::string wearer;                    ///< empty means unknown
  std::vector<driver::GloveInfo> gloves; ///< indexed by their numbers
  /// Indexed by glove number, also without a loop. Rings are omitted.
  std::vector<flow::HandInput> hands;
  std::vector<RecordedTracker> trackers; ///< the trackers of HandInput::wrist_source
  std::optional<LoopSetup> loop;         ///< nothing if only gloves were recorded
};

/// Returns a setup that begins now.
NENDO_API Setup begin_setup(std::string program);

/// Changes a loop's initial setup into that of a loop that continues from `state`. `layout` is the
/// loop's.
NENDO_API void continue_from(const flow::LoopState& state, const deform::BlockLayout& layout,
                             Setup& setup);

/// Returns the file's header and the chunks of a setup, numbered from 0, and sets `chunks` to the
/// number of these chunks.
NENDO_API std::vector<std::byte> setup_bytes(const Setup& setup, std::uint32_t& chunks);

/// Checks that the result of setup_bytes() can be read back. Error: failed, with the value that is
/// out of range, and a remedy. A recorder refuses such a setup before anything is recorded.
NENDO_API Result<void> check_readable(const Setup& setup, std::span<const std::byte> bytes);

/// Reads a chunk into `setup`. Returns false if the chunk belongs to a setup, but has content that
/// nendo does not write. Chunks of other types are ignored and give true. The result is finite and
/// usable without further checks, because enumerators, counts and sizes are checked here.
NENDO_API bool read_setup_chunk(ChunkType type, std::span<const std::byte> payload, Setup& setup);

} // namespace nendo::recording
