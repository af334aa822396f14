#include "bench/whole_frame.hpp"

#include <nendo/deform/triangles.hpp>
#include <nendo/deform/type1.hpp>

#include "bench/deform_frames.hpp"
#include "bench/gouraud.hpp"

namespace nendo::bench {

using namespace nendo::deform;

namespace {

constexpr render::Size frame_size{640, 480};
constexpr float metres_a_unit = 0.8F / 50.0F; // as large as on the loop's stage

/// From before and above, so that the fingertips' dents are seen.
render::Camera camera_of(const Points& plane) {
  std::vector<Eigen::Vector3f> corners;
  for (Eigen::Index at = 0; at < plane.cols(); ++at)
    corners.emplace_back(metres_a_unit * plane.col(at).cast<float>());
  return render::framing(corners, {25.0, -30.0},
                         static_cast<double>(frame_size.width) / frame_size.height, 0.15);
}

} // namespace

struct WholeFrame::Parts {
  Parts(const Mesh& plane, const Points& starting, double radius)
      : mesh(plane), starts(starting), ends(random_ends(starting)),
        type1(plane.vertices, starting.cols(), {one_radius(radius), with_polynomial}),
        type2(plane.vertices, starting, radius, 1, with_polynomial), renderer(frame_size),
        camera(camera_of(plane.vertices)) {
    type1.grab(starts);
    surface.corners = corners_of_triangles(mesh);
    surface.places.resize(static_cast<std::size_t>(plane.vertices.cols()));
    surface.material.colour = {0.50F, 0.30F, 0.20F};
  }

  void show(const BlockLayout& layout, const BlockShape& deformed) {
    layout.unpack(deformed, vertices);
    for (std::size_t at = 0; at < surface.places.size(); ++at)
      surface.places[at] =
          metres_a_unit * vertices.col(static_cast<Eigen::Index>(at)).cast<float>();
    render::compute_normals(surface.places, surface.corners, surface.normals);
    last = &renderer.draw(surface, camera);
  }

  static constexpr CsrbfOptions with_polynomial{.polynomial = Polynomial::linear};
  const Mesh& mesh;
  Points starts, vertices;
  std::array<Points, poses> ends;
  Type1Deformer type1;
  Strokes type2;
  BlockShape shape;
  render::Surface surface;
  GouraudRenderer renderer;
  render::Camera camera;
  const render::Image* last = nullptr;
};

WholeFrame::WholeFrame(const Mesh& mesh, const Points& starts, double radius)
    : parts_(std::make_unique<Parts>(mesh, starts, radius)) {}

WholeFrame::~WholeFrame() = default;

std::array<double, 2> WholeFrame::measure(double seconds) {
  Parts& parts = *parts_;
  const std::size_t vertices = parts.surface.places.size();
  Best t1, t2;
  for_seconds(seconds, [&] {
    parts.type2.begin();
    t2.measure(vertices, [&](std::size_t n) {
      parts.type2.stroke(n);
      parts.show(parts.type2.deformer().layout(), parts.type2.deformer().shape());
    });
    t1.measure(vertices, [&](std::size_t n) {
      parts.type1.apply(parts.ends[n % poses], parts.shape);
      parts.show(parts.type1.layout(), parts.shape);
    });
  });
  return {t1.per_second(), t2.per_second()};
}

const render::Image* WholeFrame::picture() const noexcept {
  return parts_->last;
}

double WholeFrame::covered_share() const {
  const render::Image* const drawn = picture();
  if (drawn == nullptr) return 0.0;
  GouraudRenderer other(frame_size);
  const render::Image& empty = other.draw({}, parts_->camera);
  std::size_t covered = 0;
  for (std::size_t at = 0; at < drawn->pixels().size(); ++at)
    covered += drawn->pixels()[at] != empty.pixels()[at] ? 1U : 0U;
  return static_cast<double>(covered) / static_cast<double>(drawn->pixels().size());
}

} // namespace nendo::bench
