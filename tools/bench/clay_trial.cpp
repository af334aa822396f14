#include "bench/clay_trial.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>

#include <nendo/deform/clay.hpp>
#include <nendo/deform/triangles.hpp>

#include "bench/clay_scene.hpp"
#include "bench/deform_frames.hpp"
#include "bench/percentiles.hpp"
#include "bench/plain_clay.hpp"
#include "reference/icosphere.hpp"

namespace nendo::bench {

namespace {

using deform::Mesh;
using deform::Points;

double mean_edge_of(const Mesh& mesh) {
  double sum = 0.0;
  std::size_t count = 0;
  deform::for_each_triangle(mesh, [&](const std::array<std::uint32_t, 3>& corners) {
    for (std::size_t k = 0; k < 3; ++k, ++count)
      sum += (mesh.vertices.col(corners[k]) - mesh.vertices.col(corners[(k + 1) % 3])).norm();
  });
  return sum / static_cast<double>(count);
}

/// How deep the middles of triangles and of edges lie in the hands.
double deepest_inside(const Mesh& mesh, std::span<const deform::ContactPart> parts) {
  double deepest = 0.0;
  deform::for_each_triangle(mesh, [&](const std::array<std::uint32_t, 3>& corners) {
    const auto corner = [&](std::size_t k) -> Eigen::Vector3d {
      return mesh.vertices.col(corners[k % 3]);
    };
    deepest = std::max(deepest, plain_depth(parts, (corner(0) + corner(1) + corner(2)) / 3.0));
    for (std::size_t k = 0; k < 3; ++k)
      deepest = std::max(deepest, plain_depth(parts, 0.5 * (corner(k) + corner(k + 1))));
  });
  return deepest;
}

/// Plays a scene through press(parts), which returns a deform::ClayReport, and calls see(report,
/// parts) after each call. Returns what those took that pressed something, in microseconds.
template <class Press, class See>
std::vector<double> play(const ClayTrialOptions& options, ClayScene& scene, const Press& press,
                         const See& see) {
  constexpr std::chrono::duration<double> period{1.0 / 90.0};
  std::vector<double> times_us;
  for (int tick = 1; tick <= scene.ticks(); ++tick) {
    const auto parts = scene.at(tick);
    if (options.rests) std::this_thread::sleep_for(period);
    const auto begin = ThreadClock::now();
    const deform::ClayReport report = press(parts);
    const std::chrono::duration<double, std::micro> took = ThreadClock::now() - begin;
    if (report.passes > 0) times_us.push_back(took.count());
    see(report, parts);
  }
  return times_us;
}

/// Plays the scene, each time from begin() on, the first time judging it by shape(points).
template <class Press, class Shape, class Begin>
ClayTrial run_scene(const ClayTrialOptions& options, Mesh mesh, ClayScene& scene,
                    const Press& press, const Shape& shape, const Begin& begin) {
  ClayTrial trial;
  trial.vertices = static_cast<std::size_t>(mesh.vertices.cols());
  trial.mean_edge_mm = mean_edge_of(mesh);
  const double whole = clay_volume(mesh);
  std::vector<double> left_mm, inside_mm;
  const auto see = [&](const deform::ClayReport& report, const auto& parts) {
    trial.max_remaining_path_mm = std::max(trial.max_remaining_path_mm, report.remaining_path_mm);
    trial.max_held = std::max(trial.max_held, report.held);
    if (report.passes == 0) return;
    ++trial.ticks;
    left_mm.push_back(report.penetration_mm);
    trial.constraints += report.max_constraints;
    trial.max_constraints = std::max(trial.max_constraints, report.max_constraints);
    trial.passes += report.passes;
    trial.distances += static_cast<double>(report.distances);
    shape(mesh.vertices);
    trial.last_volume = clay_volume(mesh) / whole - 1.0;
    trial.worst_volume = std::max(trial.worst_volume, std::abs(trial.last_volume));
    if (options.judges_inside) inside_mm.push_back(deepest_inside(mesh, parts));
  };
  begin();
  std::vector<double> times_us = play(options, scene, press, see);
  shape(mesh.vertices);
  trial.last_volume = clay_volume(mesh) / whole - 1.0;
  const double per_tick = 1.0 / std::max(1, trial.ticks);
  trial.constraints *= per_tick;
  trial.passes *= per_tick;
  trial.distances *= per_tick;
  for (int again = 1; again < options.scenes; ++again) {
    begin();
    const auto more = play(options, scene, press, [](const auto&, const auto&) {});
    times_us.insert(times_us.end(), more.begin(), more.end());
  }
  for (const double time_us : times_us)
    trial.mean_us += time_us / static_cast<double>(times_us.size());
  trial.p99_us = percentile(times_us, 0.99);
  trial.worst_us = times_us.empty() ? 0.0 : *std::max_element(times_us.begin(), times_us.end());
  trial.penetration_p99_mm = percentile(left_mm, 0.99);
  trial.inside_p99_mm = percentile(inside_mm, 0.99);
  trial.shape = std::move(mesh);
  return trial;
}

} // namespace

double clay_volume(const Mesh& mesh) {
  double sum = 0.0;
  deform::for_each_triangle(mesh, [&](const std::array<std::uint32_t, 3>& corners) {
    sum += mesh.vertices.col(corners[0])
               .dot(mesh.vertices.col(corners[1]).cross(mesh.vertices.col(corners[2])));
  });
  return sum / 6.0;
}

ClayTrial measure_clay(const ClayTrialOptions& options) {
  const Mesh mesh = reference::icosphere(options.level, ClayScene::ball_radius_mm);
  ClayScene scene(options.hands, options.speed_m_s);
  deform::SculptedShape shape(mesh.vertices, {});
  deform::ClayDeformer clay(shape, deform::corners_of_triangles(mesh), scene.hands(),
                            hand::HandBody::part_count,
                            {.radius_mm = options.radius_mm,
                             .friction = options.friction,
                             .keeps_volume = options.keeps_volume,
                             .grips = options.grips,
                             .max_constraints = options.max_constraints});
  return run_scene(
      options, mesh, scene, [&](auto parts) { return clay.press_to(parts); },
      [&](Points& points) { shape.layout().unpack(clay.shape(), points); },
      [&] {
        clay.release(true);
        clay.go(deform::HistoryMove::reset, scene.at(0));
      });
}

ClayTrial measure_plain_clay(const ClayTrialOptions& options) {
  const Mesh mesh = reference::icosphere(options.level, ClayScene::ball_radius_mm);
  ClayScene scene(options.hands, options.speed_m_s);
  PlainClay clay(mesh.vertices, options.radius_mm);
  return run_scene(
      options, mesh, scene, [&](auto parts) { return clay.press_to(parts); },
      [&](Points& points) { points = clay.vertices(); },
      [&] {
        clay = PlainClay(mesh.vertices, options.radius_mm);
        clay.begin(scene.at(0));
      });
}

} // namespace nendo::bench
