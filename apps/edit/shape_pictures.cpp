#include "edit/shape_pictures.hpp"

#include <pthread.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <functional>
#include <optional>
#include <string_view>
#include <utility>

#include "render/lights.hpp"
#include "render/picture.hpp"
#include "render/scene.hpp"

namespace nendo::edit {
namespace {

constexpr std::size_t dense_vertices = 6'000;
constexpr int cubes = 48; // along a dense model, which is about 90 pixels large
constexpr std::size_t max_pictures = 128;
constexpr render::View view{20.0, 8.0};

/// A model with as many vertices as a small picture can show.
struct SmallModel {
  std::vector<std::uint32_t> places; ///< its vertices, in the model's blocks
  deform::Mesh mesh;
};

/// Returns the colours of the vertices, also those of materials and textures. Sets `corners` to the
/// vertices of the triangles.
Eigen::Matrix4Xf vertex_colours(const deform::Mesh& mesh, std::vector<std::uint32_t>& corners) {
  const render::Paint paint(mesh, corners);
  Eigen::Matrix4Xf colours = Eigen::Matrix4Xf::Ones(4, mesh.vertices.cols());
  for (std::size_t at = 0; at < corners.size(); ++at) {
    const std::size_t first = at - at % 3;
    std::array<float, 3> shares{};
    shares[at % 3] = 1.0F;
    colours.col(corners[at]).head<3>() = paint.colour_at(
        at / 3, {corners[first], corners[first + 1], corners[first + 2]}, shares, 1.0F);
  }
  return colours;
}

SmallModel small_model(const flow::ModelVersion& model) {
  const deform::Mesh& mesh = model.mesh;
  const std::vector<std::uint32_t> place_of = model.layout().places();
  if (mesh.vertex_count() <= dense_vertices) return {place_of, mesh};
  std::vector<Eigen::Vector3f> rest;
  for (const auto& vertex : mesh.vertices.colwise())
    rest.emplace_back(((vertex - model.layout().origin()) / model.layout().unit()).cast<float>());
  std::vector<std::uint32_t> all;
  const Eigen::Matrix4Xf colours = vertex_colours(mesh, all);
  SmallModel small;
  std::vector<std::uint32_t> vertices; // of the model
  std::map<std::uint32_t, std::uint32_t> number_of;
  for (const std::uint32_t corner : render::coarse_corners(rest, all, cubes)) {
    const auto [at, is_new] = number_of.try_emplace(corner, vertices.size());
    if (is_new) vertices.push_back(corner);
    small.mesh.face_corners.push_back(at->second);
    if (small.mesh.face_corners.size() % 3 == 0)
      small.mesh.face_starts.push_back(static_cast<std::uint32_t>(small.mesh.face_corners.size()));
  }
  small.mesh.vertices = mesh.vertices(Eigen::all, vertices);
  small.mesh.look.vertex_colours = colours(Eigen::all, vertices);
  for (const std::uint32_t vertex : vertices)
    small.places.push_back(place_of[vertex]);
  return small;
}

} // namespace

/// Draws shapes, all from one side and as large as each other, by the worker.
class ShapePictures::Painter {
public:
  explicit Painter(double units_per_metre) : units_per_metre_(units_per_metre) {}

  /// Returns the picture, or that of an equal shape which is still shown.
  Picture of(const timeline::CachedShape& shape, std::atomic<std::uint64_t>& drawn) {
    if (shape.model != model_) take(shape.model);
    const deform::BlockLayout& layout = model_->layout();
    for (std::size_t at = 0; at < small_.places.size(); ++at)
      frame_.vertices.col(static_cast<Eigen::Index>(at)) =
          layout.origin() +
          layout.unit() * deform::vertex_at(shape.shape, small_.places[at]).cast<double>();
    const auto bytes = static_cast<std::size_t>(frame_.vertices.size()) * sizeof(double);
    const std::size_t contents = std::hash<std::string_view>()(
        {reinterpret_cast<const char*>(frame_.vertices.data()), bytes});
    std::erase_if(known_, [](const auto& one) { return one.second.expired(); });
    if (auto known = known_[contents].lock()) return known;
    builder_->build(frame_, {.ground = false}, scene_);
    const render::Lighting lighting(scene_, view.azimuth_deg, 1, 512);
    const auto picture =
        std::make_shared<const render::Image>(render::draw(lighting, camera_, picture_size, 1));
    known_[contents] = picture;
    ++drawn;
    return picture;
  }

private:
  void take(std::shared_ptr<const flow::ModelVersion> model) {
    model_ = std::move(model);
    small_ = small_model(*model_);
    builder_.emplace(small_.mesh, units_per_metre_);
    frame_.vertices = small_.mesh.vertices;
    builder_->build(frame_, {.ground = false}, scene_);
    constexpr double aspect = 1.0 * model_width_px / picture_size.height;
    camera_ = render::framing(scene_.outline(), view, aspect, 0.08);
    known_.clear();
  }

  double units_per_metre_;
  std::shared_ptr<const flow::ModelVersion> model_; ///< the one that the following are of
  SmallModel small_;
  std::optional<render::SceneBuilder> builder_;
  render::Camera camera_;
  render::SceneFrame frame_;
  render::Scene scene_;
  std::map<std::size_t, std::weak_ptr<const render::Image>> known_; ///< key: the hash of a shape
};

ShapePictures::ShapePictures(double units_per_metre)
    : painter_(std::make_unique<Painter>(units_per_metre)), worker_([this] { work(); }) {
  const sched_param none{};
  ::pthread_setschedparam(worker_.native_handle(), SCHED_IDLE, &none); // always permitted
}

ShapePictures::~ShapePictures() {
  ends_ = true;
  offered_.notify();
  hurry();
  worker_.join();
}

void ShapePictures::hurry() noexcept {
  const sched_param none{};
  ::pthread_setschedparam(worker_.native_handle(), SCHED_OTHER, &none);
}

void ShapePictures::work() {
  while (!ends_) {
    Job* job = nullptr;
    if (offer_.take(job)) {
      job->picture = painter_->of(*job->shape, drawn_);
      offer_.done();
    }
    offered_.wait(HostClock::now() + std::chrono::hours(1));
  }
}

std::vector<ShapePictures::Picture> ShapePictures::of(std::span<const Shape> shapes) {
  if (has_job_ && offer_.is_done()) {
    has_job_ = false;
    pictures_[job_.shape] = job_.picture;
    job_ = {};
  }
  if (pictures_.size() > max_pictures) keep_only(shapes);
  std::erase_if(pictures_, [](const auto& one) { return one.first.expired(); });
  std::vector<Picture> found;
  for (const Shape& shape : shapes) {
    const auto known = shape ? pictures_.find(shape) : pictures_.end();
    found.push_back(known != pictures_.end() ? known->second : nullptr);
    if (shape == nullptr || found.back() != nullptr || has_job_) continue;
    job_.shape = shape;
    has_job_ = true;
    offer_.offer(&job_);
    offered_.notify();
  }
  return found;
}

void ShapePictures::keep_only(std::span<const Shape> shapes) {
  auto all = std::exchange(pictures_, {});
  for (const Shape& shape : shapes)
    if (auto kept = shape ? all.extract(shape) : decltype(all)::node_type())
      pictures_.insert(std::move(kept));
}

} // namespace nendo::edit
