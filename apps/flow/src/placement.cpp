#include <nendo/flow/placement.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

#include <nendo/deform/dense.hpp>

namespace nendo::flow {
namespace {

using deform::Matrix6d;
using deform::Points;
using deform::Vector6d;
using Eigen::Index;
using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

/// The model's surface on the stage, thinned out so that placing stays quick on a mesh of millions.
struct Surface {
  Points points; ///< metres
  Points normals;

  Surface(const deform::Mesh& model, double units_per_metre) {
    constexpr Index max_points = 50'000;
    const Points all_normals = deform::vertex_normals(model);
    const Index stride = std::max<Index>(1, model.vertices.cols() / max_points);
    const Index count = (model.vertices.cols() + stride - 1) / stride;
    points.resize(3, count);
    normals.resize(3, count);
    for (Index i = 0; i < count; ++i) {
      points.col(i) = model.vertices.col(i * stride) / units_per_metre;
      normals.col(i) = all_normals.col(i * stride);
    }
  }

  Index nearest(const Vector3d& to) const {
    Index best = 0;
    (points.colwise() - to).colwise().squaredNorm().minCoeff(&best);
    return best;
  }
};

Fingertips moved(const Isometry3d& T, const Fingertips& tips) {
  return (T.linear() * tips).colwise() + T.translation();
}

constexpr double outwards_of(Side side) noexcept {
  return side == Side::right ? 1.0 : -1.0;
}

// A hand that holds the model from its side: fingers forward (-z), palm towards the model, thumb
// up.
Matrix3d holding_orientation(Side side) {
  const double outwards = outwards_of(side);
  Matrix3d R;
  R.col(0) = Vector3d(0.0, -outwards, 0.0); // +X of a right hand is away from its thumb
  R.col(1) = Vector3d(outwards, 0.0, 0.0);  // the back of the hand
  R.col(2) = Vector3d(0.0, 0.0, 1.0);
  return R;
}

// Where a hand that comes from the side, level at a height, meets the model first.
Vector3d first_contact(const Surface& surface, Side side, double height_fraction) {
  const Vector3d low = surface.points.rowwise().minCoeff();
  const Vector3d high = surface.points.rowwise().maxCoeff();
  const double outwards = outwards_of(side);
  const double size = std::max((high - low).maxCoeff(), 1e-12);
  const double height = low.y() + height_fraction * (high.y() - low.y());
  // The model's depth at that height, weighted by nearness; then the outermost point near the line
  // through it.
  const Eigen::ArrayXd nearness =
      (-((surface.points.row(1).array() - height) / (0.05 * size)).square()).exp();
  const double weight = nearness.sum();
  const double depth = weight > 1e-9
                           ? (surface.points.row(2).array() * nearness.transpose()).sum() / weight
                           : 0.5 * (low.z() + high.z());
  const Eigen::ArrayXd off_line = ((surface.points.row(1).array() - height).square() +
                                   (surface.points.row(2).array() - depth).square())
                                      .sqrt()
                                      .transpose();
  const double reach = std::max(0.05 * size, 1.001 * off_line.minCoeff());
  Index best = 0;
  (off_line <= reach)
      .select(outwards * surface.points.row(0).array().transpose(),
              -std::numeric_limits<double>::max())
      .maxCoeff(&best);
  return surface.points.col(best);
}

Isometry3d first_guess(const Surface& surface, Side side, const Fingertips& tips,
                       double height_fraction) {
  Isometry3d T = Isometry3d::Identity();
  // Among the hands that hold like this, choose the one whose fingertips face the model.
  const Matrix3d held = holding_orientation(side);
  const Vector3d inwards = -outwards_of(side) * Vector3d::UnitX();
  const Fingertips spread = tips.colwise() - tips.rowwise().mean();
  // The first principal axis is that of least extent.
  Vector3d facing = held * deform::eigen3_direct(spread * spread.transpose()).vectors.col(0);
  if (facing.dot(inwards) < 0.0) facing = -facing;
  const Vector3d axis = facing.cross(inwards);
  const double angle_rad = std::atan2(axis.norm(), facing.dot(inwards));
  T.linear() = Eigen::AngleAxisd(angle_rad, axis.stableNormalized()).matrix() * held;
  T.translation() =
      first_contact(surface, side, height_fraction) - T.linear() * tips.rowwise().mean();
  return T;
}

struct Registration {
  Isometry3d T; ///< so far
  Vector3d turned =
      Vector3d::Zero(); ///< how far it has been turned from the first guess, as a rotation vector
  Vector3d slid = Vector3d::Zero(); ///< how far the tips' centre has moved from there, metres
};

// One Gauss-Newton step on sum (n_i . (p_i - q_i))^2, about the tips' centre, which is all that the
// surface asks for. It leaves the hand free to wander along a flat side, so that two springs hold
// it where it was first put: turning by a radian is as dear as a gap of 2 cm, and moving by a metre
// as dear as one of 10 cm. With `anchored` false the springs only damp the step, and the last of
// the gaps closes.
void register_step(const Surface& surface, const Fingertips& tips_wrist, bool anchored,
                   Registration& at) {
  constexpr double turn_weight_m = 0.05;
  constexpr double slide_weight = 0.3;
  const Fingertips tips = moved(at.T, tips_wrist);
  const Vector3d centre = tips.rowwise().mean();
  Vector6d weights;
  weights << Vector3d::Constant(turn_weight_m), Vector3d::Constant(slide_weight);
  Vector6d displaced;
  displaced << at.turned, at.slid;
  Matrix6d H = weights.cwiseAbs2().asDiagonal();
  Vector6d g =
      anchored ? Vector6d(weights.cwiseAbs2().cwiseProduct(displaced)) : Vector6d(Vector6d::Zero());
  for (Index i = 0; i < tips.cols(); ++i) {
    const Index nearest = surface.nearest(tips.col(i));
    const Vector3d normal = surface.normals.col(nearest);
    Vector6d J;
    J << (tips.col(i) - centre).cross(normal), normal;
    H += J * J.transpose();
    g += J * normal.dot(tips.col(i) - surface.points.col(nearest));
  }
  Vector6d step = -deform::solve_spd6(H, g);
  step *= std::min(
      1.0, 0.1 / std::max(step.head<3>().norm(), 1e-12)); // nearest points change on the way
  const Eigen::AngleAxisd turn(step.head<3>().norm(), step.head<3>().stableNormalized());
  Isometry3d move = Isometry3d::Identity();
  if (turn.angle() > 0.0) move.linear() = turn.matrix();
  move.translation() = centre + step.tail<3>() - move.linear() * centre;
  at.T = move * at.T;
  at.turned += step.head<3>();
  at.slid += step.tail<3>();
}

} // namespace

Placement place_hands(const deform::Mesh& model,
                      const std::array<std::optional<Fingertips>, 2>& tips_wrist,
                      const PlacementOptions& options) {
  Placement placement;
  const Vector3d extent = model.vertices.rowwise().maxCoeff() - model.vertices.rowwise().minCoeff();
  // A model that is a single point has no size; any scale places the hands about it.
  const double size = extent.maxCoeff();
  placement.units_per_metre = size > 0.0 ? size / options.model_size_m : 1.0;

  const Surface surface(model, placement.units_per_metre);
  for (const Side side : {Side::left, Side::right}) {
    const std::size_t at = Placement::index_of(side);
    if (!tips_wrist[at]) continue;
    Isometry3d& T = placement.T_stage_wrist[at];
    T = first_guess(surface, side, *tips_wrist[at], options.height_fraction);
    constexpr int anchored_steps = 40;
    constexpr int closing_steps = 20;
    Registration registration{T};
    for (int step = 0; step < anchored_steps + closing_steps; ++step) {
      register_step(surface, *tips_wrist[at], step < anchored_steps, registration);
    }
    T = registration.T;
    T.linear() = Eigen::Quaterniond(T.linear()).normalized().toRotationMatrix();
  }
  return placement;
}

Placement place_player(const deform::Mesh& model, double model_size_m) {
  constexpr double aside_m = 0.04;  // from the model's side to the wrist
  constexpr double before_m = 0.06; // the model's front
  constexpr double height_m = 0.01; // of the wrist above the model's foot
  constexpr double forward_rad = 0.35;
  constexpr double inwards_rad = 0.25;
  Placement placement;
  const Vector3d low = model.vertices.rowwise().minCoeff();
  const Vector3d high = model.vertices.rowwise().maxCoeff();
  const double size = (high - low).maxCoeff();
  placement.units_per_metre = size > 0.0 ? size / model_size_m : 1.0;
  for (const Side side : {Side::left, Side::right}) {
    const double outwards = outwards_of(side);
    Matrix3d upright; // the back of the hand to the viewer, fingers up
    upright.col(1) = Vector3d::UnitZ();
    upright.col(2) = -Vector3d::UnitY();
    upright.col(0) = upright.col(1).cross(upright.col(2));
    Isometry3d& T = placement.T_stage_wrist[Placement::index_of(side)];
    T.linear() = (Eigen::AngleAxisd(-forward_rad, Vector3d::UnitX()) *
                  Eigen::AngleAxisd(outwards * inwards_rad, Vector3d::UnitZ()))
                     .toRotationMatrix() *
                 upright;
    const double side_x = outwards > 0.0 ? high.x() : low.x();
    T.translation() = Vector3d(side_x, low.y(), high.z()) / placement.units_per_metre +
                      Vector3d(outwards * aside_m, height_m, before_m);
  }
  return placement;
}

Placement place_without_model() noexcept {
  Placement placement;
  for (const Side side : {Side::left, Side::right})
    placement.T_stage_wrist[Placement::index_of(side)].translation().x() = 0.15 * outwards_of(side);
  return placement;
}

Table table_under(const deform::Mesh& model, double units_per_metre) noexcept {
  constexpr double min_side_m = 0.5;
  Table table{Eigen::Vector3d::Zero(), min_side_m * units_per_metre};
  if (model.vertices.cols() == 0) return table;
  const Eigen::Vector3d low = model.vertices.rowwise().minCoeff();
  const Eigen::Vector3d high = model.vertices.rowwise().maxCoeff();
  table.top = {0.5 * (low.x() + high.x()), low.y(), 0.5 * (low.z() + high.z())};
  table.half_side = std::max(table.half_side, 2.0 * (high - low).maxCoeff());
  return table;
}

} // namespace nendo::flow
