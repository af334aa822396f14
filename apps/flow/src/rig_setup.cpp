#include <nendo/flow/rig_setup.hpp>

#include <string>

#include <nendo/puppet/puppet.hpp>

namespace nendo::flow {

bool is_played(const puppet::Rig* rig) noexcept {
  return rig != nullptr && rig->puppet().is_played();
}

Eigen::Index control_points_of(const puppet::Rig* rig, const SculptorOptions& sculptor,
                               Eigen::Index hands) noexcept {
  if (is_played(rig)) return rig->starts().cols();
  return (sculptor.mirror ? 2 : 1) * sculptor.points_of_hand() * hands;
}

Eigen::Index supported_points(const puppet::Rig* rig, Eigen::Index hands) noexcept {
  if (is_played(rig)) return rig->starts().cols();
  return (mirror_of(rig) ? 10 : 5) * hands;
}

std::optional<double> mirror_of(const puppet::Rig* rig) noexcept {
  if (rig == nullptr || is_played(rig) || !rig->puppet().mirrors) return std::nullopt;
  return rig->puppet().mirror_at;
}

Result<void> check_points(const puppet::Rig* rig) {
  if (!is_played(rig) || rig->starts().cols() <= deform::CsrbfSolver::lean_size) return {};
  if (rig->puppet().distance == puppet::Distance::surface) return {};
  return Error{Errc::bad_input, "the puppet has " + std::to_string(rig->starts().cols()) +
                                    " points; a tick solves for at most " +
                                    std::to_string(deform::CsrbfSolver::lean_size) +
                                    " of them, unless distances go along the surface"};
}

void set_masks(const puppet::Rig* rig, const deform::Mesh& model, const deform::BlockLayout& layout,
               SculptorOptions& sculptor) {
  sculptor.mirror = mirror_of(rig);
  sculptor.deformer.mask =
      rig == nullptr ? nullptr : puppet::vertex_mask(rig->puppet(), layout, model.vertices);
}

Result<std::shared_ptr<const deform::SurfaceField>>
surface_for(const puppet::Rig& rig, const deform::Mesh& model, const deform::BlockLayout& layout,
            const deform::DeformerOptions& options) {
  if (!rig.puppet().is_played() || rig.puppet().distance == puppet::Distance::air)
    return std::shared_ptr<const deform::SurfaceField>();
  deform::SurfaceSetup setup = puppet::surface_setup(rig.puppet(), model, options.csrbf.kernel);
  for (deform::SurfacePoint& point : setup.points)
    point.mix.clear();
  for (const deform::OwnSupport& own : options.supports.own)
    setup.points[static_cast<std::size_t>(own.point)].mix.push_back(own.support);
  for (deform::SurfacePoint& point : setup.points) // where all are equal, none has one of its own
    if (point.mix.empty()) point.mix = options.supports.shared;
  return deform::SurfaceField::make(model, layout, setup);
}

} // namespace nendo::flow
