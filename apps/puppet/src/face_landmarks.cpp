#include <nendo/puppet/make_puppet.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include <nendo/deform/mesh.hpp>
#include <nendo/deform/surface_graph.hpp>
#include <nendo/deform/triangles.hpp>
#include <nendo/puppet/rig_check.hpp>

namespace nendo::puppet {
using deform::Mesh;
using Eigen::Vector3d;

namespace {

constexpr double nothing = -std::numeric_limits<double>::infinity();
constexpr double cells_a_side = 800.0;

/// A model seen from the front, as the height of its surface above the plane z = 0:
/// the greatest z of the surface at each place (x, y).
class FrontMap {
public:
  /// Allocates a cell for each 1/800 of the model's height, or of its width if that is more.
  explicit FrontMap(const deform::Mesh& model) : box_(deform::finite_box_of(model.vertices)) {
    const Eigen::Vector3d size = box_.highest - box_.lowest;
    const double longest = std::max(size.x(), size.y());
    cell_ = longest > 0.0 ? longest / cells_a_side : 1.0;
    columns_ = static_cast<std::ptrdiff_t>(size.x() / cell_) + 2;
    rows_ = static_cast<std::ptrdiff_t>(size.y() / cell_) + 2;
    cells_.assign(static_cast<std::size_t>(columns_ * rows_), nothing);
    deform::for_each_triangle(model, [&](const std::array<std::uint32_t, 3>& triangle) {
      Eigen::Matrix3d corners;
      for (std::size_t k = 0; k < 3; ++k)
        corners.col(static_cast<Eigen::Index>(k)) = model.vertices.col(triangle[k]);
      if (corners.allFinite()) draw(corners);
    });
  }

  double cell() const noexcept { return cell_; } ///< the side of a cell, model units
  /// Returns z there; nothing where there is no surface. All in model units.
  std::optional<double> z(double x, double y) const noexcept {
    const double column = std::floor((x - box_.lowest.x()) / cell_);
    const double row = std::floor((y - box_.lowest.y()) / cell_);
    if (!(column >= 0.0 && row >= 0.0 && column < static_cast<double>(columns_) &&
          row < static_cast<double>(rows_)))
      return std::nullopt;
    const double z = cells_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
                            static_cast<std::size_t>(column)];
    if (z == nothing) return std::nullopt;
    return z;
  }
  /// Returns the place there; where there is no surface, that at z = 0.
  Eigen::Vector3d place(double x, double y) const noexcept { return {x, y, z(x, y).value_or(0.0)}; }
  double lowest_y() const noexcept { return box_.lowest.y(); }
  double highest_y() const noexcept { return box_.highest.y(); }

private:
  void draw(const Eigen::Matrix3d& corners) {
    const Eigen::Matrix2d sides =
        (Eigen::Matrix2d() << corners.col(1).head<2>() - corners.col(0).head<2>(),
         corners.col(2).head<2>() - corners.col(0).head<2>())
            .finished();
    const double area = sides.determinant();
    if (std::abs(area) < 1e-12 * cell_ * cell_) return; // seen from its edge
    const Eigen::Matrix2d inverse = sides.inverse();
    const Eigen::Vector3d low = (corners.rowwise().minCoeff() - box_.lowest) / cell_;
    const Eigen::Vector3d high = (corners.rowwise().maxCoeff() - box_.lowest) / cell_;
    const auto last_column = std::min(columns_ - 1, static_cast<std::ptrdiff_t>(high.x()) + 1);
    const auto last_row = std::min(rows_ - 1, static_cast<std::ptrdiff_t>(high.y()) + 1);
    for (auto row = static_cast<std::ptrdiff_t>(low.y()); row <= last_row; ++row)
      for (auto column = static_cast<std::ptrdiff_t>(low.x()); column <= last_column; ++column) {
        const Eigen::Vector2d at =
            box_.lowest.head<2>() + cell_ * Eigen::Vector2d(static_cast<double>(column) + 0.5,
                                                            static_cast<double>(row) + 0.5);
        const Eigen::Vector2d part = inverse * (at - corners.col(0).head<2>());
        if (part.minCoeff() < -1e-9 || part.sum() > 1.0 + 1e-9) continue;
        const double z = corners(2, 0) + part.x() * (corners(2, 1) - corners(2, 0)) +
                         part.y() * (corners(2, 2) - corners(2, 0));
        double& cell = cells_[static_cast<std::size_t>(row * columns_ + column)];
        cell = std::max(cell, z);
      }
  }

  deform::Box box_;
  double cell_ = 1.0;
  std::ptrdiff_t columns_ = 0;
  std::ptrdiff_t rows_ = 0;
  std::vector<double> cells_; ///< row by row from the lowest y
};

// The proportions of a face as people have, in units (FaceLandmarks::unit).
constexpr double nose_to_jaw = 1.16;
constexpr double eye_height = 0.45; // of the eyes above the tip of the nose, and beside it

/// Where a profile turns: a place that is nearer to the front, or farther, than those about it.
struct Turn {
  double y;
  double z;
  bool is_forward;
};

/// The turns of a profile from above, without those of less than `least` of z.
std::vector<Turn> turns_of(const std::vector<std::pair<double, double>>& profile, double least) {
  std::vector<Turn> turns;
  if (profile.empty()) return turns;
  auto [y, z] = profile.front();
  Turn high{y, z, true}, low{y, z, false};
  bool seeks_high = true; // the profile begins at the tip of the nose
  for (const auto& [at_y, at_z] : profile) {
    if (at_z > high.z) high = {at_y, at_z, true};
    if (at_z < low.z) low = {at_y, at_z, false};
    if (seeks_high && at_z < high.z - least) {
      turns.push_back(high);
      low = {at_y, at_z, false};
      seeks_high = false;
    } else if (!seeks_high && at_z > low.z + least) {
      turns.push_back(low);
      high = {at_y, at_z, true};
      seeks_high = true;
    }
  }
  turns.push_back(seeks_high ? high : low);
  return turns;
}

class FaceFinder {
public:
  explicit FaceFinder(const Mesh& model) : model_(model), skin_(skin_of(model)), map_(skin_) {}

  Result<FaceLandmarks> find() {
    if (auto fine = find_profile(); !fine) return fine.error();
    find_symmetry();
    find_mouth();
    find_eyes();
    find_eyeball();
    find_brows();
    const double cheek_y = found_.nose.y() - 0.2 * unit();
    found_.cheek = place(facing(1.39 * eye_x(), cheek_y), cheek_y);
    find_jaw_side();
    return found_;
  }

private:
  double unit() const noexcept { return found_.unit; }
  Vector3d place(double x, double y) const { return map_.place(x, y); }
  double z(double x, double y) const {
    return map_.z(x, y).value_or(-std::numeric_limits<double>::infinity());
  }

  /// The part with the most vertices; teeth, eyes and lashes are others.
  Mesh skin_of(const Mesh& model) {
    const auto parts = deform::SurfaceGraph(model).parts();
    std::map<std::uint32_t, std::size_t> sizes;
    for (const std::uint32_t part : parts)
      ++sizes[part];
    const auto largest =
        std::ranges::max_element(sizes, {}, [](const auto& part) { return part.second; });
    Mesh skin;
    skin.vertices = model.vertices;
    for (const std::uint32_t part : parts)
      found_.is_skin.push_back(largest != sizes.end() && part == largest->first);
    for (std::size_t face = 0; face < model.face_count(); ++face) {
      const auto corners = model.corners_of(face);
      if (corners.empty() || !found_.is_skin[corners[0]]) continue;
      skin.face_corners.insert(skin.face_corners.end(), corners.begin(), corners.end());
      skin.face_starts.push_back(static_cast<std::uint32_t>(skin.face_corners.size()));
    }
    return skin;
  }

  Result<void> find_profile() {
    const double step = map_.cell();
    double top = map_.highest_y();
    while (top > map_.lowest_y() && !map_.z(0.0, top))
      top -= step;
    found_.nose = Vector3d(0.0, top, z(0.0, top));
    for (double y = top; y > map_.lowest_y(); y -= step)
      if (z(0.0, y) > found_.nose.z()) found_.nose = place(0.0, y);
    const double above = top - found_.nose.y();
    if (!(above > 20.0 * step))
      return Error{Errc::bad_input,
                   "its most forward place in the middle is at its top, so that it "
                   "has no nose; a face must look along +z, with y up"};
    if (!find_jaw(above))
      return Error{Errc::bad_input,
                   "nothing under its most forward place in the middle goes back as "
                   "a chin does; a face must look along +z, with y up"};
    found_.unit = (found_.nose.y() - found_.jaw.y()) / nose_to_jaw;
    find_turns();
    return {};
  }
  /// Under the chin, the profile goes back farther than anywhere else below the nose.
  bool find_jaw(double above) {
    const double step = map_.cell(), window = 0.08 * above;
    double most = 0.0, at = found_.nose.y();
    for (double y = found_.nose.y() - 0.2 * above; y > found_.nose.y() - 1.4 * above; y -= step) {
      const auto here = map_.z(0.0, y), below = map_.z(0.0, y - window);
      if (!here || (!below && most > 0.5 * window)) break; // the model ends there
      const double drop = below ? *here - *below : window;
      if (!(drop > most)) continue;
      most = drop;
      at = y;
    }
    if (!(most > 0.5 * window)) return false;
    // Up from there, the chin is where the profile is upright first; its lower edge is below that.
    const double stride = 0.02 * above;
    while (at < found_.nose.y() && z(0.0, at + stride) - z(0.0, at) > 0.15 * stride)
      at += step;
    found_.chin = place(0.0, at);
    while (z(0.0, at - step) > found_.chin.z() - 0.045 * above)
      at -= step;
    found_.jaw = place(0.0, at);
    return true;
  }
  std::vector<std::pair<double, double>> profile(double x, double from, double to) const {
    std::vector<std::pair<double, double>> profile;
    for (double y = from; y > to; y -= map_.cell())
      if (const auto here = map_.z(x, y)) profile.emplace_back(y, *here);
    return profile;
  }
  void find_turns() {
    turns_ = turns_of(profile(0.0, found_.nose.y(), found_.jaw.y()), 0.008 * unit());
    found_.under_nose = place(0.0, found_.nose.y() - 0.22 * unit());
    if (turns_.size() > 1 && turns_[1].y > found_.nose.y() - 0.45 * unit())
      found_.under_nose = place(0.0, turns_[1].y);
  }

  void find_symmetry() {
    const auto images = mirror_images(model_.vertices, RigCheck::image_within *
                                                           deform::diagonal_of(model_.vertices));
    found_.lone_vertices = static_cast<std::size_t>(
        std::ranges::count_if(images, [](const auto& image) { return image.empty(); }));
    std::vector<double> differences;
    for (double y = found_.jaw.y(); y < found_.nose.y() + unit(); y += 0.02 * unit())
      for (double x = 0.02 * unit(); x < 0.8 * unit(); x += 0.02 * unit()) {
        const auto one = map_.z(x, y), other = map_.z(-x, y);
        if (one && other) differences.push_back(std::abs(*one - *other) / unit());
      }
    if (differences.empty()) return;
    const auto middle = differences.begin() + static_cast<std::ptrdiff_t>(differences.size() / 2);
    std::nth_element(differences.begin(), middle, differences.end());
    found_.asymmetry = *middle;
  }

  /// How much longer the way along the skin is than that through the air.
  double detour(const Vector3d& from, const Vector3d& to) const {
    const auto start = deform::nearest_position(skin_, from),
               end = deform::nearest_position(skin_, to);
    const double air = (start.in(skin_.vertices) - end.in(skin_.vertices)).norm();
    if (!(air > 0.0)) return 1.0;
    constexpr double most = 4.0;
    const Eigen::VectorXd distances = graph().distances(start, most * air);
    double least = most * air;
    for (const std::uint32_t corner : end.corners)
      least = std::min(least, distances[corner] +
                                  (skin_.vertices.col(corner) - end.in(skin_.vertices)).norm());
    return least / air;
  }
  const deform::SurfaceGraph& graph() const {
    if (!graph_) graph_.emplace(skin_);
    return *graph_;
  }

  /// Of the hollows of the profile, the one around which the skin makes the longest detour.
  void find_mouth() {
    constexpr double min_detour = 1.8;
    double longest = min_detour;
    for (std::size_t at = 1; at + 1 < turns_.size(); ++at) {
      const Turn &upper = turns_[at - 1], &hollow = turns_[at], &lower = turns_[at + 1];
      if (hollow.is_forward || upper.y > found_.nose.y() - 0.05 * unit()) continue;
      const double here = detour(place(0.0, upper.y), place(0.0, lower.y));
      if (here < longest) continue;
      longest = here;
      found_.mouth = MouthPlaces{place(0.0, upper.y), place(0.0, hollow.y), place(0.0, lower.y),
                                 Vector3d::Zero()};
    }
    if (found_.mouth && !find_corner(*found_.mouth)) found_.mouth.reset();
  }
  /// Follows the slit to the side for as long as it parts the skin.
  bool find_corner(MouthPlaces& mouth) const {
    const double step = 0.02 * unit(), half = 0.06 * unit();
    double y = mouth.slit.y(), last = 0.0, last_y = y;
    for (double x = step; x < 0.9 * unit() && x < last + 4.0 * step; x += step) {
      y = slit_at(x, y);
      if (detour(place(x, y + half), place(x, y - half)) < 1.6) continue;
      last = x;
      last_y = y;
    }
    if (last < 0.1 * unit()) return false;
    mouth.corner = place(last + half, last_y); // so far, a detour about the corner seems one
    return true;
  }
  /// The deepest place near y, beside the slope of the face.
  double slit_at(double x, double y) const {
    const double reach = 0.05 * unit();
    const double above = z(x, y + reach), below = z(x, y - reach);
    double deepest = 0.0, found = y;
    for (double at = y - reach; at <= y + reach; at += map_.cell()) {
      const double part = (at - y + reach) / (2.0 * reach);
      const double depth = below + part * (above - below) - z(x, at);
      if (!(depth > deepest)) continue;
      deepest = depth;
      found = at;
    }
    return found;
  }

  bool is_pocket(double x, double y) const {
    const double least = 0.07 * unit(), here = z(x, y);
    bool above = false, below = false;
    for (double away = 0.0; away < 0.16 * unit(); away += map_.cell()) {
      above = above || z(x, y + away) > here + least;
      below = below || z(x, y - away) > here + least;
    }
    return above && below;
  }
  /// An eye is the tallest pocket of its column, column by column.
  std::optional<std::pair<double, double>> pocket_at(double x) const {
    std::optional<std::pair<double, double>> tallest, run;
    for (double y = found_.nose.y() + 0.1 * unit(); y < found_.nose.y() + unit();
         y += map_.cell()) {
      if (!is_pocket(x, y)) {
        run.reset();
        continue;
      }
      if (!run) run = {y, y};
      run->second = y;
      if (!tallest || run->second - run->first > tallest->second - tallest->first) tallest = run;
    }
    return tallest;
  }
  void find_eyes() {
    const double step = 0.01 * unit();
    std::optional<double> begin;
    std::pair<double, double> across{0.0, 0.0};
    for (double x = 0.08 * unit(); x < unit(); x += step) {
      if (!pocket_at(x)) {
        begin.reset();
        continue;
      }
      if (!begin) begin = x;
      if (x - *begin > across.second - across.first) across = {*begin, x};
    }
    const double width = across.second - across.first;
    if (width < 0.12 * unit()) return;
    const double edge = 0.012 * unit();
    EyePlaces eye{{}, {}, across.first, across.second};
    for (std::size_t k = 0; k < 3; ++k) {
      const double x = across.first + 0.25 * static_cast<double>(k + 1) * width;
      const auto pocket = pocket_at(x);
      if (!pocket) return;
      eye.upper[k] = place(x, pocket->second + edge);
      eye.lower[k] = place(x, pocket->first - edge);
    }
    if (detour(eye.upper[1], eye.lower[1]) > 1.5) found_.eye = eye;
  }
  /// A part that is about as wide as high and deep, beside the nose.
  void find_eyeball() {
    const auto parts = deform::SurfaceGraph(model_).parts();
    std::map<std::uint32_t, deform::Box> boxes;
    for (std::size_t v = 0; v < parts.size(); ++v) {
      const Vector3d at = model_.vertices.col(static_cast<Eigen::Index>(v));
      auto& box = boxes.try_emplace(parts[v], deform::Box{at, at}).first->second;
      box.lowest = box.lowest.cwiseMin(at);
      box.highest = box.highest.cwiseMax(at);
    }
    for (const auto& [part, box] : boxes) {
      const Vector3d size = box.highest - box.lowest;
      if (size.minCoeff() < 0.8 * size.maxCoeff() || size.maxCoeff() < 0.2 * unit() ||
          size.maxCoeff() > 0.8 * unit() || box.lowest.x() < 0.0 ||
          box.lowest.y() < found_.nose.y() || box.highest.y() > found_.nose.y() + 1.2 * unit())
        continue;
      found_.eyeball_front =
          std::max(found_.eyeball_front.value_or(box.highest.z()), box.highest.z());
      if (!found_.eye) eyeball_x_ = 0.5 * (box.lowest.x() + box.highest.x());
    }
  }
  double eye_x() const noexcept {
    if (found_.eye) return found_.eye->upper[1].x();
    return eyeball_x_.value_or(eye_height * unit());
  }

  /// Goes towards the middle, up to where the skin looks to the front more than to the side.
  double facing(double x, double y) const {
    const double away = 0.06 * unit();
    while (x > 0.25 * unit() && !(z(x - away, y) - z(x + away, y) < 2.4 * away))
      x -= 0.02 * unit();
    return x;
  }
  /// How far the skin protrudes there, along a line from above to below; < 0 in a hollow.
  double bulge(double x, double y) const {
    const double away = 0.1 * unit();
    const double sum = z(x, y + away) + z(x, y - away);
    return std::isfinite(sum) ? z(x, y) - 0.5 * sum : 0.0;
  }
  double max_bulging(double x, double from, double to, double sign) const {
    double best = 0.5 * (from + to), most = 0.0;
    for (double y = from; y <= to; y += map_.cell()) {
      const double here = sign * bulge(x, y);
      if (here <= most) continue;
      most = here;
      best = y;
    }
    return best;
  }
  /// The brow protrudes above the eye, or above the hollow where an eye would be.
  void find_brows() {
    const double nose = found_.nose.y();
    const double eye = found_.eye
                           ? 0.5 * (found_.eye->upper[1].y() + found_.eye->lower[1].y())
                           : max_bulging(eye_x(), nose + 0.2 * unit(), nose + 0.9 * unit(), -1.0);
    const double inner_x = found_.eye ? 0.65 * found_.eye->inner_x : 0.17 * unit();
    const double outer_x = facing(1.2 * eye_x(), eye + 0.35 * unit());
    const double outer = max_bulging(outer_x, eye + 0.31 * unit(), eye + 0.44 * unit(), 1.0);
    found_.brow_outer = place(outer_x, outer);
    found_.brow_inner = place(inner_x, outer - 0.05 * unit());
  }
  /// On the jaw's edge; where the face is narrow, nearer to the middle.
  void find_jaw_side() {
    const double y = found_.jaw.y() + 0.2 * unit();
    double x = 0.62 * unit();
    while (x > 0.3 * unit() && !(z(x, y) > found_.nose.z() - 1.1 * unit()))
      x -= 0.02 * unit();
    found_.jaw_side = place(x, y);
  }

  const Mesh& model_;
  FaceLandmarks found_;
  Mesh skin_;
  FrontMap map_;
  std::vector<Turn> turns_; ///< the profile's turns, from the tip of the nose to the jaw
  std::optional<double> eyeball_x_;
  mutable std::optional<deform::SurfaceGraph> graph_;
};

} // namespace

Result<FaceLandmarks> find_face(const Mesh& model) {
  if (model.face_corners.empty())
    return Error{Errc::bad_input, "has no face, and a puppet needs a surface"};
  if (!model.vertices.allFinite())
    return Error{Errc::bad_input, "has vertices that are not finite"};
  return FaceFinder(model).find();
}

} // namespace nendo::puppet
