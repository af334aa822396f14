#pragma once
// The measurements of `nendo bench deform`: the deformers beside a plain loop on the plane of the
// paper's Table 1, and, on models of a million vertices and more, beside the best that the machine
// can do.

#include <cstddef>

#include <nendo/deform/mesh.hpp>

namespace nendo::bench {

/// The microseconds of a frame, the best of many. A frame has new displacements, solving, and all
/// vertices; one of Type-2 has assembling and factorising.
struct CellTimes {
  double plain1_us = 0.0; ///< 0 if the processor has no AVX2
  double plain2_us = 0.0;
  double type1_us = 0.0;
  double evaluated1_us = 0.0; ///< Type-1 without weights
  double type2_us = 0.0;
  double type1_2threads_us = 0.0;
  double type2_2threads_us = 0.0;
  double grab_us = 0.0;
  double apart = 0.0; ///< the most that Type-1 differs from double, of the model's diagonal
  std::size_t weight_bytes = 0;
};

CellTimes measure_cell(const deform::Points& mesh, double radius, int repetitions);

/// A large model of which ten supports, a fifth of its size, reach a part.
struct LargeTimes {
  std::size_t vertices = 0;
  std::size_t reached = 0;    ///< in blocks that some support reaches
  std::size_t influences = 0; ///< vertices within a support, summed over supports
  double type1_us = 0.0;
  double evaluated1_us = 0.0;
  double type2_us = 0.0;
  double memory_us = 0.0;     ///< to read and write 24 bytes for each reached vertex
  double arithmetic_us = 0.0; ///< the influences, at the pace of a model that fits the first cache
};

LargeTimes measure_large(int cells, int repetitions);

/// Ten supports that reach all of a model, whose start points go a third of a radius: what it costs
/// to keep the volume.
struct VolumeTimes {
  std::size_t vertices = 0;
  double air_ns = 0.0;     ///< an influence
  double between_ns = 0.0; ///< with keep_volume of a half
  double clay_ns = 0.0;
  double type1_us = 0.0;      ///< a tick, with weights if there is memory for them
  double evaluated1_us = 0.0; ///< without
  double type1_clay_us = 0.0;
  double type2_us = 0.0; ///< a piece of a twentieth of a radius
  double type2_clay_us = 0.0;
};

VolumeTimes measure_volume(int cells, int repetitions);

} // namespace nendo::bench
