#include <nendo/flow/step.hpp>

namespace nendo::flow {
namespace {

constexpr std::array<std::string_view, 21> step_names{
    "stroke",   "reset",     "mode",  "kernel", "radius", "folding", "filter",
    "settings", "subdivide", "brush", "puppet", "volume", "hold",    "mask",
    "symmetry", "refine",    "cut",   "join",   "copy",   "remove",  "topology"};

} // namespace

std::string_view name_of(StepKind kind) noexcept {
  return step_names[static_cast<std::size_t>(kind)];
}

} // namespace nendo::flow
