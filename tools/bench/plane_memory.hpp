#pragma once
// Checks whether there is memory for the benchmark of a large plane.

#include <string>

namespace nendo::bench {

/// Returns true if there is enough free memory for deformers of table1_plane(cells). Otherwise
/// prints a note that names the benchmark.
bool has_memory_for_plane(int cells, const std::string& benchmark);

} // namespace nendo::bench
