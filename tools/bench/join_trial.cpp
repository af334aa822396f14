#include "bench/join_trial.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>

#include <nendo/deform/join.hpp>

namespace nendo::bench {
namespace {

using deform::Mesh;

/// A ball about a place on the x axis, of triangles, with all that a mesh can carry.
Mesh dressed_ball(std::size_t rings, double middle) {
  Mesh mesh;
  const auto segments = static_cast<std::uint32_t>(2 * rings);
  const auto count = static_cast<std::uint32_t>(rings);
  mesh.vertices.resize(3, 2 + static_cast<Eigen::Index>(rings) * segments);
  mesh.vertices.col(0) << middle, 0.0, 1.0;
  mesh.vertices.col(1) << middle, 0.0, -1.0;
  for (std::uint32_t ring = 0; ring < count; ++ring)
    for (std::uint32_t at = 0; at < segments; ++at) {
      const double polar = std::numbers::pi * (ring + 1) / (count + 1);
      const double turn = 2.0 * std::numbers::pi * at / segments;
      mesh.vertices.col(2 + ring * segments + at) << middle + std::sin(polar) * std::cos(turn),
          std::sin(polar) * std::sin(turn), std::cos(polar);
    }
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    mesh.face_corners.insert(mesh.face_corners.end(), {a, b, c});
    mesh.face_starts.push_back(static_cast<std::uint32_t>(mesh.face_corners.size()));
  };
  for (std::uint32_t at = 0; at < segments; ++at) {
    const std::uint32_t next = (at + 1) % segments;
    const std::uint32_t last = 2 + (count - 1) * segments;
    add(0, 2 + at, 2 + next);
    for (std::uint32_t from = 2; from < last; from += segments) {
      add(from + at, from + segments + at, from + segments + next);
      add(from + at, from + segments + next, from + next);
    }
    add(last + at, 1, last + next);
  }
  mesh.texcoords = 0.5 * (mesh.vertices.topRows(2).array() + 1.0);
  mesh.corner_texcoords = mesh.face_corners;
  mesh.look.vertex_colours = Eigen::Matrix4Xf::Ones(4, mesh.vertices.cols());
  mesh.look.materials = {{"clay", Eigen::Vector4f(0.8f, 0.5f, 0.3f, 1.0f)}};
  mesh.look.face_materials.assign(mesh.face_count(), 0);
  return mesh;
}

} // namespace

JoinTrial measure_join(std::size_t rings, int runs) {
  const Mesh a = dressed_ball(rings, 0.0);
  const Mesh b = dressed_ball(rings, 1.0);
  const deform::JoinPart parts[] = {{&a, "one"}, {&b, "other"}};
  JoinTrial trial{.triangles = a.face_count(),
                  .sharp_ms = std::numeric_limits<double>::infinity(),
                  .smeared_ms = std::numeric_limits<double>::infinity(),
                  .fine = true};
  const auto time = [&](double seam, double& best) {
    const auto begin = std::chrono::steady_clock::now();
    const auto joined = deform::join(parts, {.seam_width = seam});
    const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - begin;
    best = std::min(best, took.count());
    trial.fine = trial.fine && joined;
    if (!joined || seam > 0.0) return;
    trial.crossings = joined->steps[0].crossings;
    // Two balls of radius 1 at a distance of 1 share a lens of 5 pi / 12.
    const double exact = 2.0 * 4.0 / 3.0 * std::numbers::pi - 5.0 / 12.0 * std::numbers::pi;
    trial.volume_error = std::abs(joined->steps[0].volume - exact) / exact;
  };
  for (int run = 0; run < runs; ++run) {
    time(0.0, trial.sharp_ms);
    time(0.1, trial.smeared_ms);
  }
  return trial;
}

} // namespace nendo::bench
