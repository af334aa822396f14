// A loop in which gloves shape a model.

#include <algorithm>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <nendo/deform/mesh_file.hpp>
#include <nendo/deform/offset.hpp>
#include <nendo/deform/triangles.hpp>
#include <nendo/flow/setting.hpp>
#include <nendo/sculpting/live_loop.hpp>

#include "c/boundary.hpp"

namespace nendo::c {
namespace {

struct Loop {
  explicit Loop(sculpting::LiveLoop begun)
      : live(std::move(begun)), corners(deform::corners_of_triangles(live.model())) {}

  sculpting::LiveLoop live;
  const std::vector<std::uint32_t> corners;
  bool has_finished = false;
};

std::string text_of(const char* text) {
  return text == nullptr ? "" : text;
}

Result<sculpting::LiveOptions> options_of(const nendo_loop_options* given) {
  sculpting::LiveOptions options;
  if (given == nullptr) return options;
  options.left = text_of(given->left);
  options.right = text_of(given->right);
  options.calibration.user = text_of(given->user);
  if (given->mode != nullptr) {
    const auto mode = flow::mode_named(given->mode);
    if (!mode) return Error{Errc::usage, "mode: use " + flow::setting::mode.choices()};
    options.mode = *mode;
  }
  if (given->rate_hz != 0.0) options.pace.rate_hz = given->rate_hz;
  if (given->model_size_m != 0.0) options.model_size_m = given->model_size_m;
  if (given->radius_m != 0.0) options.radius_m = given->radius_m;
  options.realtime.priority = given->priority;
  for (const std::uint32_t reserved : given->reserved)
    if (reserved != 0)
      return Error{Errc::usage, "reserved: fill the options with zeros before you set some"};
  return options;
}

Result<deform::Mesh> mesh_of(const double* vertices, std::size_t vertex_count,
                             const std::uint32_t* triangles, std::size_t triangle_count) {
  constexpr std::size_t max_count = std::size_t{1} << 30;
  if (vertex_count == 0 || vertex_count > max_count || triangle_count > max_count)
    return Error{Errc::usage, "vertex_count, triangle_count: use 1 to 1073741824"};
  deform::Mesh mesh;
  mesh.vertices =
      Eigen::Map<const deform::Points>(vertices, 3, static_cast<Eigen::Index>(vertex_count));
  if (!mesh.vertices.allFinite()) return Error{Errc::usage, "vertices: a number is not finite"};
  const std::span corners(triangles, 3 * triangle_count);
  if (std::any_of(corners.begin(), corners.end(),
                  [&](std::uint32_t corner) { return corner >= vertex_count; }))
    return Error{Errc::usage, "triangles: an index is of no vertex"};
  mesh.face_corners.assign(corners.begin(), corners.end());
  for (std::size_t end = 3; end <= corners.size(); end += 3)
    mesh.face_starts.push_back(static_cast<std::uint32_t>(end));
  return mesh;
}

/// Begins a loop by `begin_live`, which gets the options.
template <class Begin>
Result<void> begin(const nendo_loop_options* given, nendo_loop** begun, Begin begin_live) {
  if (begun == nullptr) return is_null("begun");
  const auto options = options_of(given);
  if (!options) return options.error();
  Result<sculpting::LiveLoop> live = begin_live(*options);
  if (!live) return live.error();
  *begun = object_of<nendo_loop>(std::make_unique<Loop>(*std::move(live)));
  return {};
}

/// Calls `act` with a loop that runs.
template <class Act>
int with_running(nendo_loop* loop, Act act) noexcept {
  return guarded([&]() -> Result<void> {
    if (loop == nullptr) return is_null("loop");
    Loop& running = *own<Loop>(loop);
    if (running.has_finished) return Error{Errc::failed, "the loop has finished"};
    return act(running);
  });
}

std::uint32_t flags_of(const flow::HandFrame& hand) noexcept {
  return NENDO_PRESENT | (hand.silent ? std::uint32_t{NENDO_SILENT} : 0U) |
         (hand.tracked ? std::uint32_t{NENDO_TRACKED} : 0U) |
         (hand.lost ? std::uint32_t{NENDO_LOST} : 0U);
}

const Loop& of(const nendo_loop* loop) noexcept {
  return *own<const Loop>(loop);
}
Loop& of(nendo_loop* loop) noexcept {
  return *own<Loop>(loop);
}

} // namespace
} // namespace nendo::c

using namespace nendo;
using c::Loop;
using c::of;
using c::with_running;

extern "C" {

int nendo_loop_begin(const char* model_file, const struct nendo_loop_options* options,
                     nendo_loop** begun) {
  return c::guarded([&]() -> Result<void> {
    if (model_file == nullptr) return c::is_null("model_file");
    return c::begin(options, begun, [&](const sculpting::LiveOptions& live) {
      return sculpting::LiveLoop::begin(std::string(model_file), live);
    });
  });
}

int nendo_loop_begin_with(const double* vertices, size_t vertex_count, const uint32_t* triangles,
                          size_t triangle_count, const struct nendo_loop_options* options,
                          nendo_loop** begun) {
  return c::guarded([&]() -> Result<void> {
    if (vertices == nullptr) return c::is_null("vertices");
    if (triangles == nullptr) return c::is_null("triangles");
    auto mesh = c::mesh_of(vertices, vertex_count, triangles, triangle_count);
    if (!mesh) return mesh.error();
    deform::count_from(deform::usual_offset(*mesh), *mesh);
    return c::begin(options, begun, [&](const sculpting::LiveOptions& live) {
      return sculpting::LiveLoop::begin(*std::move(mesh), live);
    });
  });
}

void nendo_loop_end(nendo_loop* loop) {
  delete c::own<Loop>(loop);
}

size_t nendo_loop_vertex_count(const nendo_loop* loop) {
  return of(loop).live.model().vertex_count();
}

size_t nendo_loop_triangle_count(const nendo_loop* loop) {
  return of(loop).corners.size() / 3;
}

void nendo_loop_triangles(const nendo_loop* loop, uint32_t* triangles) {
  std::copy(of(loop).corners.begin(), of(loop).corners.end(), triangles);
}

int nendo_loop_update(nendo_loop* loop) {
  return !of(loop).has_finished && of(loop).live.update() ? 1 : 0;
}

void nendo_loop_hands(nendo_loop* loop, struct nendo_hand hands[2]) {
  const flow::Frame& frame = of(loop).live.frame();
  for (std::size_t side = 0; side < frame.hands.size(); ++side) {
    const flow::HandFrame& from = frame.hands[side];
    hands[side] = {};
    if (!from.present) continue;
    hands[side].flags = c::flags_of(from);
    hands[side].side = static_cast<std::uint32_t>(side);
    hands[side].samples = from.samples;
    hands[side].time_s = to_seconds(from.sampled.time_since_epoch());
    c::write_pose(from.angles, from.pose, hands[side]);
  }
}

void nendo_loop_vertices(nendo_loop* loop, double* vertices) {
  const deform::Mesh& model = of(loop).live.model();
  Eigen::Map<deform::Points> out(vertices, 3, model.vertices.cols());
  out = of(loop).live.vertices().colwise() + model.offset;
}

double nendo_loop_units_per_metre(const nendo_loop* loop) {
  return of(loop).live.frame().units_per_metre;
}

int nendo_loop_ask(nendo_loop* loop, int request) {
  return with_running(loop, [&](Loop& own) -> Result<void> {
    if (request < 0 || request >= static_cast<int>(flow::requests.size()))
      return Error{Errc::usage, "request: use NENDO_GRAB to NENDO_REGRAB"};
    return own.live.ask(flow::requests[static_cast<std::size_t>(request)]);
  });
}

int nendo_loop_change(nendo_loop* loop, const char* setting, const char* value) {
  return with_running(loop, [&](Loop& own) -> Result<void> {
    if (setting == nullptr) return c::is_null("setting");
    if (value == nullptr) return c::is_null("value");
    flow::LoopSettings settings = own.live.settings();
    if (const auto changed = flow::set_from_text(settings, setting, value); !changed)
      return Error{Errc::usage, changed.error().message};
    return own.live.ask(flow::ChangeSettings{settings});
  });
}

int nendo_loop_has_ended(const nendo_loop* loop) {
  return of(loop).has_finished || of(loop).live.has_ended() ? 1 : 0;
}

int nendo_loop_save(nendo_loop* loop, const char* file) {
  return with_running(loop, [&](Loop& own) -> Result<void> {
    if (file == nullptr) return c::is_null("file");
    own.has_finished = true;
    deform::Mesh mesh = own.live.finish();
    deform::count_from(Eigen::Vector3d::Zero(), mesh);
    return deform::write_mesh(file, mesh);
  });
}
}
