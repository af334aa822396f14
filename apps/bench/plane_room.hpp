#pragma once
// Whether a large plane is to be measured at all.

#include <string>

namespace nendo::bench {

/// Whether there is memory left for deformers of table1_plane(cells); if not, says so, and in which
/// benchmark.
bool has_room_for_plane(int cells, const std::string& benchmark);

} // namespace nendo::bench
