// Whether what is about to be recorded can be read again.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

#include "setup_parts.hpp"

namespace nendo::recording {
namespace {

constexpr double farthest_wrist_m = 1e6; // as setup_loop.cpp reads
constexpr double largest_readable = 1e100;
constexpr double min_readable = 1e-100;
constexpr std::size_t max_puppet_text = std::size_t{1} << 20;

bool is_in_range(double value) noexcept {
  return value >= min_readable && value <= largest_readable;
}

/// What of a loop is out of its range, and what to do.
std::string reason_of_loop(const LoopSetup& loop) {
  if (loop.mesh.size() > UINT16_MAX)
    return "the models' names are too long; run it in their folder";
  if (!is_in_range(loop.placement.units_per_metre))
    return "the model's size is not within 1e-100 and 1e100; scale it";
  for (const auto& wrist : loop.placement.T_stage_wrist)
    if (!(wrist.translation().cwiseAbs().maxCoeff() <= farthest_wrist_m))
      return "a hand stands more than 1000 km from the model's middle; take out the vertices that "
             "lie so far away, or move the hand nearer";
  const auto& supports = loop.options.sculptor.deformer.supports;
  if (!supports.are_usable() || !is_in_range(loop.options.sculptor.piece_length))
    return "a radius is not within 1e-98 and 1e100 model units; choose another --radius";
  return "a setting of the loop is out of its range; leave out the options that you do not need";
}

std::string reason_of(ChunkType type, const Setup& setup) {
  if (type == hand_chunk)
    return "a hand's size, calibration or filter has a number that no hand has; calibrate again, "
           "or use --calibration none";
  if (type == loop_chunk && setup.loop) return reason_of_loop(*setup.loop);
  if (type == puppet_chunk && setup.loop && setup.loop->puppet.text.size() > max_puppet_text)
    return "its puppet is longer than 1 MiB; take functions or masks out of it";
  if (type == puppet_chunk)
    return "its puppet has a number that is out of its range; mend its file";
  if (type == rest_chunk || type == origin_chunk)
    return "the shape has a vertex that is too far away; reset it first";
  return "what describes the gloves cannot be read; name other gloves";
}

} // namespace

Result<void> check_readable(const Setup& setup, std::span<const std::byte> bytes) {
  if (setup.loop && setup.loop->mesh.size() > UINT16_MAX) // a writer cuts strings off there
    return Error{Errc::failed, "this run cannot be recorded: " + reason_of_loop(*setup.loop)};
  auto chunks = ChunkReader::of(bytes, "the recording");
  if (!chunks) return chunks.error();
  Setup read;
  while (const auto chunk = chunks->next()) {
    if (!read_setup_chunk(chunk->type, chunk->payload, read))
      return Error{Errc::failed, "this run cannot be recorded: " + reason_of(chunk->type, setup)};
  }
  if (chunks->damage_count() == 0) return {};
  return Error{Errc::failed, "this run cannot be recorded: its shape does not fit; reset it first"};
}

} // namespace nendo::recording
