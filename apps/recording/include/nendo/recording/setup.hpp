#pragma once
// What a recording begins with: who, when, with what, and everything that a loop is made from, so
// that another one can be made that does the same.

#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <nendo/driver/chunk_file.hpp>
#include <nendo/driver/glove.hpp>
#include <nendo/flow/deform_loop.hpp>

namespace nendo::recording {

/// By which a model is known again: how many vertices, and CRC-32C of their coordinates, x y z of
/// one after another, as little-endian doubles.
struct ShapeSum {
  std::uint64_t vertices = 0;
  std::uint32_t crc = 0;
  friend bool operator==(const ShapeSum&, const ShapeSum&) = default;
};
ShapeSum sum_of(const deform::Points& vertices) noexcept;

struct LoopSetup {
  std::string mesh; ///< the file's name, as it was given
  ShapeSum mesh_sum;
  flow::Placement placement; ///< without the gaps
  /// Without the pointers, the stages, and `spin`, `longest_wait` and `evaluation.threads`, of
  /// which no shape depends.
  flow::LoopOptions options;
  /// Which vector instructions evaluated the field: others may round another way.
  std::string simd;
};

struct Setup {
  std::chrono::sys_time<std::chrono::nanoseconds> begun; ///< by the clock on the wall
  HostTime begun_host{};                                 ///< the same moment by the other clock
  std::string program;                                   ///< what recorded it: "nendo 0.1.0"
  std::string wearer;                                    ///< empty: not told
  std::vector<driver::GloveInfo> gloves;                 ///< by their numbers
  /// By their gloves' numbers, also without a loop. Without the rings and measured bones.
  std::vector<flow::HandInput> hands;
  std::optional<LoopSetup> loop; ///< nothing: gloves alone were recorded
};

/// A setup that begins now.
Setup begin_setup(std::string program);

/// The file's header and the chunks of a setup, numbered from 0; as many as `chunks` then says.
std::vector<std::byte> setup_bytes(const Setup& setup, std::uint32_t& chunks);

/// Puts what a chunk tells into `setup`. False: it is a setup's, but holds what no nendo writes.
/// Chunks of other types change nothing and are fine. What comes out is finite, and usable as it
/// is: enumerators, counts and sizes are judged.
bool read_setup_chunk(driver::ChunkType type, std::span<const std::byte> payload, Setup& setup);

} // namespace nendo::recording
