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

/// One hand of the loop, by its number; also of a recording without a loop.
struct HandSetup {
  Side side = Side::right; ///< as which it shapes
  hand::HandSize size;
  GloveSample first; ///< the pose in which it took hold of the model
  bool gated = true;
  hand::FilterOptions filter;
  std::optional<CountScale> adapt;
  std::optional<hand::LearnedRanges> learned; ///< what that went on from
  hand::Calibration calibration;              ///< of gloves of the first sample's side
  hand::Calibration swapped;                  ///< of the other side's
  hand::HandSize swapped_size;                ///< of the hand in them

  /// `ring` as HandInput has it.
  flow::HandInput input(SampleRing* ring) const;
};

/// As `input` and skeletons of these sizes are.
HandSetup hand_setup(const flow::HandInput& input, const hand::HandSize& size,
                     const hand::HandSize& swapped_size);

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
  std::vector<HandSetup> hands;                          ///< by their gloves' numbers
  std::optional<LoopSetup> loop;                         ///< nothing: gloves alone were recorded
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
