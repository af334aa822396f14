#include <nendo/puppet/rig_check.hpp>

#include <algorithm>
#include <limits>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nendo/deform/surface_deformer.hpp>
#include <nendo/deform/triangles.hpp>
#include <nendo/deform/type1.hpp>

namespace nendo::puppet {

using deform::Points;

struct RigShapes::Parts {
  Parts(std::shared_ptr<const Rig> of, const deform::Mesh& model,
        const deform::DeformerOptions& options)
      : rig(std::move(of)), shape(model.vertices, options), out(shape.shape()) {}

  std::shared_ptr<const Rig> rig;
  deform::SculptedShape shape;
  deform::BlockShape out;
  std::optional<deform::SurfaceDeformer> along; ///< one of them
  std::optional<deform::Type1Deformer> through;
  double condition = 0.0;
};

RigShapes::RigShapes(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
RigShapes::~RigShapes() = default;

Result<std::unique_ptr<RigShapes>> RigShapes::make(std::shared_ptr<const Rig> rig,
                                                   const deform::Mesh& model) {
  deform::DeformerOptions options;
  options.supports = rig->supports();
  auto parts = std::make_unique<Parts>(std::move(rig), model, options);
  const Points& starts = parts->rig->starts();
  deform::FieldStatus status{};
  if (parts->rig->puppet().distance == Distance::surface) {
    auto field = deform::SurfaceField::make(
        model, parts->shape.layout(),
        surface_setup(parts->rig->puppet(), model, options.csrbf.kernel));
    if (!field) return field.error();
    parts->condition = (*field)->condition();
    status = parts->along.emplace(parts->shape, *std::move(field)).grab(starts);
  } else {
    options.mask = vertex_mask(parts->rig->puppet(), parts->shape.layout(), model.vertices);
    status = parts->through.emplace(parts->shape, starts.cols(), options).grab(starts);
  }
  if (!deform::is_solved(status))
    return Error{Errc::bad_input,
                 "the points cannot grab the model: " + std::string(describe(status))};
  return std::unique_ptr<RigShapes>(new RigShapes(std::move(parts)));
}

const deform::BlockShape& RigShapes::blocks_at(std::span<const double> values) {
  Points ends;
  parts_->rig->place(values, ends);
  return blocks_with(ends);
}

const deform::BlockShape& RigShapes::blocks_with(const Points& ends) {
  if (parts_->along)
    parts_->along->apply(ends, parts_->out);
  else
    parts_->through->apply(ends, parts_->out);
  return parts_->out;
}

Points RigShapes::at(std::span<const double> values) {
  Points vertices;
  parts_->shape.layout().unpack(blocks_at(values), vertices);
  return vertices;
}

Points RigShapes::at(std::size_t function, double value) {
  std::vector<double> values(function + 1, 0.0);
  values.back() = value;
  return at(values);
}

double RigShapes::condition() const noexcept {
  return parts_->condition;
}

const Rig& RigShapes::rig() const noexcept {
  return *parts_->rig;
}

using Eigen::Index;
using Eigen::Vector3d;

namespace {

Vector3d area_normal(const Points& vertices, const std::uint32_t* corners) {
  const Vector3d first = vertices.col(corners[0]);
  return (vertices.col(corners[1]) - first).cross(vertices.col(corners[2]) - first);
}

/// Compares shapes of a model with its rest.
class TurnCounter {
public:
  explicit TurnCounter(const deform::Mesh& model)
      : rest_(model.vertices), corners_(deform::corners_of_triangles(model)),
        diagonal_(deform::diagonal_of(model.vertices)) {}

  void count(const Points& shape, LimitCheck& into) const {
    const double still = 1e-6 * diagonal_;
    const double no_area = 1e-14 * diagonal_ * diagonal_;
    for (std::size_t at = 0; at < corners_.size(); at += 3) {
      const std::uint32_t* const corners = &corners_[at];
      const bool moves = std::any_of(corners, corners + 3, [&](std::uint32_t corner) {
        return (shape.col(corner) - rest_.col(corner)).squaredNorm() > still * still;
      });
      if (!moves) continue;
      ++into.moved;
      const Vector3d normal = area_normal(rest_, corners);
      if (normal.norm() > no_area && normal.dot(area_normal(shape, corners)) < 0.0) ++into.turned;
    }
  }

private:
  const Points& rest_;
  std::vector<std::uint32_t> corners_;
  double diagonal_;
};

std::vector<AtLimit> limits_of(const Puppet& puppet) {
  std::vector<AtLimit> limits;
  for (std::size_t at = 0; at < puppet.functions.size(); ++at)
    for (const double value : {puppet.functions[at].least, puppet.functions[at].most})
      if (value != 0.0) limits.push_back({at, value});
  return limits;
}

Points shape_at(RigShapes& shapes, const AtLimit& one, const AtLimit& other) {
  std::vector<double> values(shapes.rig().puppet().functions.size(), 0.0);
  values[one.function] = one.value;
  values[other.function] = other.value;
  return shapes.at(values);
}

void check_pairs(RigShapes& shapes, const TurnCounter& counter, const std::vector<AtLimit>& limits,
                 RigCheck& check) {
  const auto& functions = shapes.rig().puppet().functions;
  for (std::size_t a = 0; a < limits.size(); ++a)
    for (std::size_t b = a + 1; b < limits.size(); ++b) {
      if (functions[limits[a].function].input == functions[limits[b].function].input) continue;
      LimitCheck& pair = check.pairs.emplace_back(LimitCheck{limits[a], limits[b]});
      counter.count(shape_at(shapes, limits[a], limits[b]), pair);
    }
}

/// The farthest that a vertex is from the mirror image of its twin.
double apart(const Points& shape, const std::vector<std::vector<std::uint32_t>>& images) {
  double most = 0.0;
  for (std::size_t v = 0; v < images.size(); ++v) {
    if (images[v].empty()) continue;
    double least = std::numeric_limits<double>::infinity();
    for (const std::uint32_t at : images[v]) {
      Vector3d image = shape.col(at);
      image.x() = -image.x();
      least = std::min(least, (shape.col(static_cast<Index>(v)) - image).norm());
    }
    most = std::max(most, least);
  }
  return most;
}

/// Of the mirror images of each vertex, those that are the nearest at rest: there are several where
/// parts of the model touch.
std::vector<std::vector<std::uint32_t>> nearest_images(const Points& rest, double diagonal) {
  auto images = mirror_images(rest, RigCheck::image_within * diagonal);
  for (std::size_t v = 0; v < images.size(); ++v) {
    const auto gap = [&](std::uint32_t at) {
      Vector3d image = rest.col(at);
      image.x() = -image.x();
      return (rest.col(static_cast<Index>(v)) - image).norm();
    };
    double least = std::numeric_limits<double>::infinity();
    for (const std::uint32_t at : images[v])
      least = std::min(least, gap(at));
    const double most = least + 0.5 * RigCheck::symmetric_within * diagonal;
    std::erase_if(images[v], [&](std::uint32_t at) { return gap(at) > most; });
  }
  return images;
}

void check_twins(RigShapes& shapes, const deform::Mesh& model, RigCheck& check) {
  const double diagonal = deform::diagonal_of(model.vertices);
  const auto images = nearest_images(model.vertices, diagonal);
  if (diagonal > 0.0) check.model_apart = apart(model.vertices, images) / diagonal;
  check.lone_vertices = static_cast<std::size_t>(
      std::ranges::count_if(images, [](const auto& image) { return image.empty(); }));
  const Puppet& puppet = shapes.rig().puppet();
  for (std::size_t left = 0; left < puppet.functions.size(); ++left) {
    const Function& function = puppet.functions[left];
    const auto right = puppet.function_named(twin_of(function.name));
    if (!function.name.ends_with("Left") || !right) continue;
    const Points shape =
        shape_at(shapes, {left, function.most}, {*right, puppet.functions[*right].most});
    check.twins.push_back({left, *right, diagonal > 0.0 ? apart(shape, images) / diagonal : 0.0});
  }
}

/// Points by their x, so that those near a mirror image are found by a binary search.
std::vector<std::uint32_t> by_x(const Points& points) {
  std::vector<std::uint32_t> order(static_cast<std::size_t>(points.cols()));
  std::iota(order.begin(), order.end(), std::uint32_t{0});
  std::ranges::sort(order, {}, [&](std::uint32_t at) { return points(0, at); });
  return order;
}

} // namespace

std::vector<std::vector<std::uint32_t>> mirror_images(const Points& points, double tolerance) {
  const auto order = by_x(points);
  std::vector<std::vector<std::uint32_t>> images(order.size());
  for (std::size_t v = 0; v < images.size(); ++v) {
    Vector3d image = points.col(static_cast<Index>(v));
    image.x() = -image.x();
    auto at = std::ranges::lower_bound(order, image.x() - tolerance, {},
                                       [&](std::uint32_t point) { return points(0, point); });
    for (; at != order.end() && points(0, *at) <= image.x() + tolerance; ++at)
      if ((points.col(*at) - image).norm() <= tolerance) images[v].push_back(*at);
  }
  return images;
}

bool RigCheck::passes() const noexcept {
  return std::ranges::none_of(alone, folds);
}

RigCheck check_rig(RigShapes& shapes, const deform::Mesh& model) {
  RigCheck check;
  const TurnCounter counter(model);
  const auto limits = limits_of(shapes.rig().puppet());
  for (const AtLimit& limit : limits)
    counter.count(shapes.at(limit.function, limit.value),
                  check.alone.emplace_back(LimitCheck{limit}));
  check_pairs(shapes, counter, limits, check);
  check_twins(shapes, model, check);
  return check;
}

} // namespace nendo::puppet
