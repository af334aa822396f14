#pragma once
// Measures pressed clay: the library, and a plain scalar program of the same method.

#include <cstddef>

#include <nendo/deform/mesh.hpp>

namespace nendo::bench {

struct ClayTrial {
  std::size_t vertices = 0;
  double mean_edge_mm = 0.0;
  int ticks = 0;            ///< in which something was pressed
  double constraints = 0.0; ///< the mean of the ticks' largest
  int max_constraints = 0;
  double passes = 0.0;    ///< a tick
  double distances = 0.0; ///< a tick
  double mean_us = 0.0;
  double p99_us = 0.0;
  double worst_us = 0.0;
  double penetration_p99_mm = 0.0; ///< at vertices, before the last push
  double inside_p99_mm = 0.0;      ///< after it, in triangles' middles and edges' middles
  double worst_volume = 0.0;       ///< relative, of all ticks
  double last_volume = 0.0;
  double max_remaining_path_mm = 0.0;
  std::size_t max_held = 0;
  deform::Mesh shape; ///< at the end
};

struct ClayTrialOptions {
  int level = 6; ///< level of the icosphere
  int hands = 2;
  double speed_m_s = 0.5;
  double radius_mm = 30.0;
  double friction = 0.5; ///< the plain program has none
  bool keeps_volume = true;
  bool grips = true;
  int max_constraints = 256;  ///< per pass
  bool judges_inside = false; ///< takes long
  bool rests = false; ///< sleeps between ticks, as a loop at 90 Hz does: the caches are cold then
  int scenes = 1;     ///< repetitions from the ball, for the times
};

double clay_volume(const deform::Mesh& mesh);

ClayTrial measure_clay(const ClayTrialOptions& options);
/// Computes the same by plain loops in double, one vertex and one part after the other.
ClayTrial measure_plain_clay(const ClayTrialOptions& options);

} // namespace nendo::bench
