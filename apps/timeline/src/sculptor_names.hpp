#pragma once
// Words of the solver's choices in a timeline's file, by their numbers.

#include <array>
#include <string_view>

namespace nendo::timeline {

inline constexpr std::array<std::string_view, 4> order_names{"by_size", "as_given", "octree",
                                                             "minimum_degree"};
inline constexpr std::array<std::string_view, 3> storage_names{"by_size", "dense", "sparse"};

} // namespace nendo::timeline
