// Deforming vertices.

#include <algorithm>
#include <memory>
#include <string>
#include <utility>

#include <nendo/deform/type1.hpp>

#include "c/boundary.hpp"

namespace nendo::c {
namespace {

struct Deformer {
  Deformer(deform::Points vertices, Eigen::Index control_points,
           const deform::DeformerOptions& options)
      : points(control_points), deformer(std::move(vertices), control_points, options) {}

  Eigen::Index points;
  deform::Type1Deformer deformer;
  deform::BlockShape shape;
};

constexpr double max_coordinate = 1e100; // the solver's
constexpr std::size_t max_count = std::size_t{1} << 31;

Eigen::Map<const deform::Points> points_at(const double* numbers, Eigen::Index count) {
  return {numbers, 3, count};
}

Result<void> result_of(deform::FieldStatus status) {
  if (is_solved(status)) return {};
  return Error{Errc::failed, std::string(deform::describe(status))};
}

Result<std::unique_ptr<Deformer>> make(const double* vertices, std::size_t vertex_count,
                                       std::size_t control_points, double radius,
                                       const char* kernel) {
  const auto named = deform::wendland_named(kernel == nullptr ? "wendland-c2" : kernel);
  if (!named)
    return Error{Errc::usage, "kernel: use wendland-c0, wendland-c2, wendland-c4 or wendland-c6"};
  if (vertex_count == 0 || vertex_count > max_count)
    return Error{Errc::usage, "vertex_count: use 1 to 2147483648"};
  if (control_points == 0 || control_points > max_count)
    return Error{Errc::usage, "control_points: use 1 to 2147483648"};
  if (!(radius > 0.0 && radius < max_coordinate))
    return Error{Errc::usage, "radius: use a number above 0"};
  const deform::Points points = points_at(vertices, static_cast<Eigen::Index>(vertex_count));
  if (!(points.cwiseAbs().maxCoeff() < max_coordinate) || !points.allFinite())
    return Error{Errc::usage, "vertices: a number is not finite"};
  deform::DeformerOptions options;
  options.supports = deform::one_radius(radius);
  options.csrbf.kernel = *named;
  return std::make_unique<Deformer>(points, static_cast<Eigen::Index>(control_points), options);
}

/// Calls `act` with the deformer and the points.
template <class Act>
int with_points(nendo_deformer* deformer, const double* points, Act act) noexcept {
  return guarded([&]() -> Result<void> {
    if (deformer == nullptr) return is_null("deformer");
    if (points == nullptr) return is_null("points");
    Deformer& made = *own<Deformer>(deformer);
    return result_of(act(made, deform::Points(points_at(points, made.points))));
  });
}

} // namespace
} // namespace nendo::c

using namespace nendo;
using c::Deformer;
using c::with_points;

extern "C" {

int nendo_deformer_make(const double* vertices, size_t vertex_count, size_t control_points,
                        double radius, const char* kernel, nendo_deformer** made) {
  return c::guarded([&]() -> Result<void> {
    if (vertices == nullptr) return c::is_null("vertices");
    if (made == nullptr) return c::is_null("made");
    auto deformer = c::make(vertices, vertex_count, control_points, radius, kernel);
    if (!deformer) return deformer.error();
    *made = c::object_of<nendo_deformer>(*std::move(deformer));
    return {};
  });
}

void nendo_deformer_free(nendo_deformer* deformer) {
  delete c::own<Deformer>(deformer);
}

int nendo_deformer_grab(nendo_deformer* deformer, const double* points) {
  return with_points(deformer, points, [](Deformer& own, const deform::Points& starts) {
    return own.deformer.grab(starts);
  });
}

int nendo_deformer_move(nendo_deformer* deformer, const double* points, double* vertices) {
  if (vertices == nullptr) return c::fail(Errc::usage, "vertices: is null");
  return with_points(deformer, points, [&](Deformer& own, const deform::Points& ends) {
    const deform::FieldStatus status = own.deformer.apply(ends, own.shape);
    deform::Points moved;
    own.deformer.layout().unpack(own.shape, moved);
    std::copy_n(moved.data(), moved.size(), vertices);
    return status;
  });
}

int nendo_deformer_commit(nendo_deformer* deformer, const double* points) {
  return with_points(deformer, points, [](Deformer& own, const deform::Points& ends) {
    return own.deformer.commit(ends);
  });
}
}
