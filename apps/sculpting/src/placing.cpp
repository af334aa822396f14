#include <nendo/sculpting/placing.hpp>

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <utility>

#include <nendo/deform/mesh.hpp>
#include <nendo/flow/clay_hands.hpp>
#include <nendo/flow/sculptor.hpp>
#include <nendo/hand/joint_angles.hpp>

namespace nendo::sculpting {
namespace {

hand::JointAngles first_angles(const flow::HandInput& hand) {
  const hand::WearerHand& own = hand.wearer.of(hand.first.side);
  return hand::joint_angles(hand.first, own.calibration, own.left_out);
}

/// Hands that press clay begin beside it, from where bent fingers or a moved hand reach it.
void place_beside(std::span<const flow::HandInput> hands, const deform::Mesh& model,
                  flow::Placement& placement) {
  constexpr double clear_m = 0.010;
  for (const auto& hand : hands) {
    const Side glove = hand.first.side;
    Eigen::Isometry3d& wrist = placement.T_stage_wrist[flow::Placement::index_of(hand.side)];
    wrist = flow::beside(model, placement.units_per_metre, hand.skeleton(glove), first_angles(hand),
                         wrist, clear_m);
  }
}

} // namespace

double usual_size_m(flow::Mode mode) noexcept {
  constexpr double statue_m = 0.8;
  constexpr double clay_m = 0.075;
  constexpr double parts_m = 0.25;
  if (mode == flow::Mode::clay) return clay_m;
  return mode == flow::Mode::parts ? parts_m : statue_m;
}

deform::Supports usual_supports(const deform::Mesh& model, flow::Mode mode) {
  constexpr double fraction = 0.2;       // 16 cm on the stage
  constexpr double clay_fraction = 0.32; // a ball of 7.5 cm yields within 2.4 cm of a hand
  const deform::Box box = deform::box_of_faces(model);
  const double size = (box.highest - box.lowest).maxCoeff();
  return deform::one_radius((mode == flow::Mode::clay ? clay_fraction : fraction) *
                            (size > 0.0 ? size : 1.0));
}

void set_supports(deform::Supports supports, flow::SculptorOptions& sculptor) {
  // Far below the step at which a single finger would fold the surface, 0.47 of the radius.
  constexpr double piece_fraction = 0.05;
  sculptor.piece_length = piece_fraction * deform::min_radius(supports);
  sculptor.deformer.supports = std::move(supports);
  sculptor.deformer.csrbf.merge_fraction = flow::fingertip_merge_fraction;
}

void set_undo_space(const deform::Mesh& model, std::size_t max_bytes, flow::LoopOptions& loop) {
  // Memory for some dozens of whole shapes, of which strokes mostly change parts.
  constexpr std::size_t max_at_once = std::size_t{64} << 20;
  constexpr std::size_t bytes_per_vertex = std::size_t{64} * 3 * sizeof(float);
  const std::size_t at_once =
      std::min({max_at_once, max_bytes,
                bytes_per_vertex * static_cast<std::size_t>(model.vertices.cols() + 1000)});
  loop.sculptor.deformer.undo_bytes = at_once;
  loop.undo_max_bytes = max_bytes - at_once;
}

flow::Placement place(const deform::Mesh& whole, std::span<const flow::HandInput> hands,
                      const PlacingOptions& options) {
  const auto faces = deform::without_stray_vertices(whole);
  const deform::Mesh& model = faces ? *faces : whole;
  std::array<std::optional<flow::Fingertips>, 2> tips;
  for (const auto& hand : hands) {
    tips[flow::Placement::index_of(hand.side)] =
        hand.skeleton(hand.first.side)
            .pose(first_angles(hand), Eigen::Isometry3d::Identity())
            .fingertip_positions();
  }
  flow::Placement placement =
      options.is_for_player
          ? flow::place_player(model)
          : flow::place_hands(model, tips, {.model_size_m = options.model_size_m});
  if (options.mode == flow::Mode::clay) place_beside(hands, model, placement);
  return placement;
}

Result<std::unique_ptr<flow::DeformLoop>> make_loop(const deform::Mesh& model,
                                                    const flow::Placement& placement,
                                                    const std::vector<flow::HandInput>& hands,
                                                    const flow::LoopOptions& options,
                                                    const deform::BlockShape* first) {
  if (const auto fine = flow::check_inputs(hands); !fine) return fine.error();
  const auto fine = flow::check_points(options.rig.get());
  if (!fine) return fine.error();
  auto loop = std::make_unique<flow::DeformLoop>(model, placement, hands, options, first);
  if (!is_solved(loop->grab_status())) {
    return Error{Errc::failed, "the hands cannot grab the model: " +
                                   std::string(deform::describe(loop->grab_status()))};
  }
  return loop;
}

} // namespace nendo::sculpting
