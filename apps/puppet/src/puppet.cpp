#include <nendo/puppet/puppet.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <set>
#include <tuple>
#include <utility>

#include <nendo/base/files.hpp>
#include <nendo/deform/triangles.hpp>
#include <nendo/hand/angle.hpp>

namespace nendo::puppet {
namespace {

constexpr std::size_t first_tip = hand::finger_count + hand::angle_count;
constexpr std::size_t count = first_tip + 3 * hand::finger_count;

std::string finger_name(std::size_t finger) {
  return std::string(hand::name_of(static_cast<hand::Finger>(finger)));
}

std::string name_of(std::size_t number) {
  if (number < hand::finger_count) return finger_name(number) + "_flexion";
  if (number < first_tip) return std::string(hand::angle_names[number - hand::finger_count]);
  const std::size_t tip = number - first_tip;
  return finger_name(tip / 3) + "_tip_" + "xyz"[tip % 3];
}

} // namespace

std::optional<HandSignal> HandSignal::named(std::string_view name) noexcept {
  const auto point = name.find('.');
  const auto side = side_named(name.substr(0, point));
  if (point == std::string_view::npos || !side) return std::nullopt;
  for (std::size_t number = 0; number < count; ++number)
    if (name.substr(point + 1) == name_of(number))
      return HandSignal(*side, static_cast<std::uint8_t>(number));
  return std::nullopt;
}

std::optional<HandSignal> HandSignal::numbered(Side side, std::uint8_t number) noexcept {
  if (number >= count) return std::nullopt;
  return HandSignal(side, number);
}

HandSignal HandSignal::mirrored() const noexcept {
  return {opposite(side_), number_};
}

std::string HandSignal::name() const {
  return (side_ == Side::left ? "left." : "right.") + name_of(number_);
}

bool HandSignal::is_angle() const noexcept {
  return number_ < first_tip;
}

std::uint8_t HandSignal::finger() const noexcept {
  if (number_ < hand::finger_count) return number_;
  if (number_ >= first_tip) return static_cast<std::uint8_t>((number_ - first_tip) / 3);
  // Four angles of the thumb, four of each finger, then palm and wrist.
  return std::min(static_cast<std::uint8_t>((number_ - hand::finger_count) / 4), no_finger);
}

Eigen::Vector3d HandSignal::direction() const noexcept {
  const auto axis = static_cast<Eigen::Index>((number_ - first_tip) % 3);
  Eigen::Vector3d direction = Eigen::Vector3d::Unit(axis);
  if (side_ == Side::left && axis == 0) direction = -direction; // x points to a left hand's thumb
  return direction;
}

double HandSignal::of(const HandState& hand) const noexcept {
  if (number_ < hand::finger_count)
    return hand.angles.flexion_rad(static_cast<hand::Finger>(number_));
  if (number_ < first_tip) return hand.angles[hand::angle_at(number_ - hand::finger_count)];
  const std::size_t tip = number_ - first_tip;
  const Eigen::Vector3d world =
      hand.pose.fingertip_positions().col(static_cast<Eigen::Index>(tip / 3));
  const Eigen::Vector3d place =
      hand.T_world_wrist.linear().transpose() * (world - hand.T_world_wrist.translation());
  return direction().dot(place);
}

using deform::Mesh;
using deform::Points;
using deform::SurfacePosition;
using Eigen::Index;
using Eigen::Vector3d;

namespace {

constexpr std::array<std::string_view, 4> means_names{"none", "fist", "pinch", "switch"};

/// Vertices on parts of the surface without a point.
std::vector<std::uint32_t> vertices_without_points(const std::vector<std::uint32_t>& parts,
                                                   const std::vector<SurfacePosition>& places) {
  std::set<std::uint32_t> with_points;
  for (const SurfacePosition& place : places)
    with_points.insert(parts[place.corners[0]]);
  std::vector<std::uint32_t> vertices;
  for (std::uint32_t vertex = 0; vertex < parts.size(); ++vertex)
    if (!with_points.contains(parts[vertex])) vertices.push_back(vertex);
  return vertices;
}

/// A vertex belongs to the first part that takes it.
std::vector<deform::FollowingPart>
following_parts(const Puppet& puppet, const Mesh& model,
                const std::vector<std::uint32_t>& parts_of_surface,
                const std::vector<SurfacePosition>& places) {
  std::vector<deform::FollowingPart> parts(puppet.parts.size());
  for (std::size_t part = 0; part < parts.size(); ++part) {
    parts[part].is_affine = puppet.parts[part].is_affine;
    for (const std::size_t point : puppet.parts[part].points)
      parts[part].points.push_back(static_cast<Eigen::Index>(point));
  }
  if (parts.empty()) return parts;
  for (const std::uint32_t vertex : vertices_without_points(parts_of_surface, places)) {
    const Vector3d place = model.vertices.col(vertex);
    const auto takes = std::ranges::find_if(puppet.parts, [&](const PuppetPart& part) {
      return vertex >= part.first && vertex <= part.last &&
             (!part.inside || part.inside->contains(place));
    });
    if (takes != puppet.parts.end())
      parts[static_cast<std::size_t>(takes - puppet.parts.begin())].vertices.push_back(vertex);
  }
  return parts;
}

/// 0 within half of the radius, 1 outside, smooth in between.
double passes(const Mask& mask, const Vector3d& place) {
  const double part = 2.0 * (place - mask.at).norm() / mask.radius - 1.0;
  const double t = std::clamp(part, 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

/// The nearest place of the edges in the plane x = 0, if they are about as near as any: a point in
/// the middle then is its own mirror image, also where the nearest places are two, beside it.
SurfacePosition nearest_in_middle(const Mesh& model, const Vector3d& at) {
  const SurfacePosition nearest = deform::nearest_position(model, at);
  const double near = 1e-3 * deform::diagonal_of(model.vertices);
  double least = (nearest.in(model.vertices) - at).norm() + near;
  SurfacePosition best = nearest;
  const auto is_middle = [&](std::uint32_t v) { return model.vertices(0, v) == 0.0; };
  deform::for_each_triangle(model, [&](const std::array<std::uint32_t, 3>& corners) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = corners[k], b = corners[(k + 1) % 3];
      if (!is_middle(a) || !is_middle(b)) continue;
      const Vector3d from = model.vertices.col(a), along = model.vertices.col(b) - from;
      const double part =
          std::clamp(along.dot(at - from) / std::max(along.squaredNorm(), 1e-300), 0.0, 1.0);
      const double away = (from + part * along - at).norm();
      if (away >= least) continue;
      least = away;
      best = {{a, b, b}, {1.0 - part, part, 0.0}};
    }
  });
  return best;
}

/// A twin is on the same part of the surface: beside the skin of a lid there are lashes and eyes.
std::vector<SurfacePosition> positions_on(const Puppet& puppet, const Mesh& model,
                                          const std::vector<std::uint32_t>& parts) {
  const auto vertices = static_cast<std::uint32_t>(model.vertices.cols());
  std::vector<SurfacePosition> places;
  for (const PuppetPoint& point : puppet.points) {
    const bool at_vertex = point.vertex && *point.vertex < vertices;
    Vector3d at = at_vertex ? Vector3d(model.vertices.col(*point.vertex)) : point.at;
    if (point.is_mirrored) {
      const std::uint32_t of =
          at_vertex ? *point.vertex : deform::nearest_position(model, at).corners[0];
      at.x() = -at.x();
      places.push_back(deform::nearest_position(model, at, parts, parts[of]));
      continue;
    }
    if (at_vertex)
      places.push_back(SurfacePosition::at_vertex(*point.vertex));
    else if (at.x() == 0.0)
      places.push_back(nearest_in_middle(model, at));
    else
      places.push_back(deform::nearest_position(model, at));
  }
  return places;
}

} // namespace

std::optional<std::size_t> Puppet::function_named(std::string_view name) const noexcept {
  const auto found = std::ranges::find(functions, name, &Function::name);
  if (found == functions.end()) return std::nullopt;
  return static_cast<std::size_t>(found - functions.begin());
}

bool operator==(const Puppet& one, const Puppet& other) noexcept {
  const auto all = [](const Puppet& puppet) {
    return std::tie(puppet.model, puppet.distance, puppet.mirrors, puppet.mirror_at, puppet.points,
                    puppet.functions, puppet.parts, puppet.masks, puppet.inverted, puppet.clutch);
  };
  return all(one) == all(other);
}

std::string twin_of(const std::string& name) {
  constexpr std::string_view left = "Left", right = "Right";
  for (const auto& [ending, other] : {std::pair{left, right}, std::pair{right, left}})
    if (name.ends_with(ending))
      return name.substr(0, name.size() - ending.size()) + std::string(other);
  return name;
}

std::string_view name_of(ClutchTrigger means) noexcept {
  return means_names[static_cast<std::size_t>(means)];
}

std::optional<ClutchTrigger> clutch_trigger_named(std::string_view name) noexcept {
  for (std::size_t at = 0; at < means_names.size(); ++at)
    if (means_names[at] == name) return static_cast<ClutchTrigger>(at);
  return std::nullopt;
}

Result<Puppet> read_puppet(const std::filesystem::path& path) {
  constexpr std::size_t max_bytes = std::size_t{1} << 20;
  const auto text = read_file(path, max_bytes, "puppet");
  if (!text) return text.error();
  return parse_puppet(*text, path.string());
}

Result<void> check_fits(const Puppet& puppet, const Mesh& model) {
  if (puppet.is_played() && model.face_corners.empty())
    return Error{Errc::bad_input, puppet.model + ": has no face, and a puppet needs a surface"};
  const auto vertices = static_cast<std::uint32_t>(model.vertices.cols());
  for (const PuppetPoint& point : puppet.points)
    if (point.vertex && *point.vertex >= vertices)
      return Error{Errc::bad_input, puppet.model + ": has no vertex " +
                                        std::to_string(*point.vertex) + ", where the point '" +
                                        point.name + "' is to be; they go from 0 to " +
                                        std::to_string(vertices - 1)};
  return {};
}

std::vector<SurfacePosition> positions_on(const Puppet& puppet, const Mesh& model) {
  return positions_on(puppet, model, deform::SurfaceGraph(model).parts());
}

deform::SurfaceSetup surface_setup(const Puppet& puppet, const Mesh& model,
                                   deform::Wendland kernel) {
  deform::SurfaceSetup setup;
  setup.kernel = kernel;
  const auto parts = deform::SurfaceGraph(model).parts();
  const auto places = positions_on(puppet, model, parts);
  for (std::size_t at = 0; at < places.size(); ++at)
    setup.points.push_back(
        {places[at], puppet.points[at].radius, puppet.points[at].name, puppet.points[at].mix});
  setup.parts = following_parts(puppet, model, parts, places);
  setup.mask = mask_weights(puppet, model.vertices);
  return setup;
}

Eigen::VectorXd mask_weights(const Puppet& puppet, const deform::Points& vertices) {
  Eigen::VectorXd weights;
  if (puppet.masks.empty() && !puppet.inverted) return weights;
  weights.setOnes(vertices.cols());
  for (const Mask& mask : puppet.masks)
    for (Eigen::Index v = 0; v < weights.size(); ++v)
      weights[v] = std::min(weights[v], passes(mask, vertices.col(v)));
  if (puppet.inverted) weights = 1.0 - weights.array();
  return weights;
}

std::shared_ptr<const deform::VertexMask> vertex_mask(const Puppet& puppet,
                                                      const deform::BlockLayout& layout,
                                                      const deform::Points& vertices) {
  const Eigen::VectorXd weights = mask_weights(puppet, vertices);
  if (weights.size() == 0) return nullptr;
  return std::make_shared<const deform::VertexMask>(layout, weights);
}

namespace {

constexpr double tolerance = 1e-4; // of the diagonal, between a vertex and the image of another
constexpr Index max_looked_at = 1000;
constexpr double max_alone = 0.05; // of them

/// Returns which part of the vertices that are looked at has no image in the plane x = at.
double part_alone(const Points& vertices, const std::vector<Index>& by_x, double at) {
  const double near = tolerance * deform::diagonal_of(vertices);
  const Index step = std::max<Index>(1, vertices.cols() / max_looked_at);
  const auto x_of = [&](Index vertex) { return vertices(0, vertex); };
  Index looked_at = 0, alone = 0;
  for (Index v = 0; v < vertices.cols(); v += step, ++looked_at) {
    Vector3d image = vertices.col(v);
    image.x() = 2.0 * at - image.x();
    auto other = std::ranges::lower_bound(by_x, image.x() - near, {}, x_of);
    bool found = false;
    for (; !found && other != by_x.end() && vertices(0, *other) <= image.x() + near; ++other)
      found = (vertices.col(*other) - image).norm() <= near;
    if (!found) ++alone;
  }
  return looked_at == 0 ? 1.0 : static_cast<double>(alone) / static_cast<double>(looked_at);
}

} // namespace

double plane_of_symmetry(const Points& vertices) {
  if (vertices.cols() == 0 || !vertices.allFinite()) return 0.0;
  const double middle = 0.5 * (vertices.row(0).minCoeff() + vertices.row(0).maxCoeff());
  if (std::abs(middle) <= tolerance * deform::diagonal_of(vertices)) return 0.0;
  std::vector<Index> by_x(static_cast<std::size_t>(vertices.cols()));
  std::iota(by_x.begin(), by_x.end(), Index{0});
  std::ranges::sort(by_x, {}, [&](Index at) { return vertices(0, at); });
  return part_alone(vertices, by_x, middle) <= max_alone ? middle : 0.0;
}

} // namespace nendo::puppet
