#include <nendo/deform/edit_part.hpp>

#include <algorithm>

#include <nendo/deform/corner_colours.hpp>

#include "join/mesh_surface.hpp"
#include "parts/append_mesh.hpp"

namespace nendo::deform {
namespace {

constexpr double gap_of_width = 0.1; // of the widest model's width

/// What each mesh is to have, so that all are alike.
struct Shared {
  bool colours = false, corner_colours = false, texture = false, materials = false, groups = false,
       objects = false;
};

Shared shared_by(std::span<const Mesh> models) {
  Shared shared;
  for (const Mesh& model : models) {
    shared.colours = shared.colours || model.look.vertex_colours.cols() > 0;
    shared.corner_colours = shared.corner_colours || model.look.texcoord_colours.cols() > 0;
    shared.texture = shared.texture || !model.corner_texcoords.empty();
    shared.materials = shared.materials || !model.look.face_materials.empty();
    shared.groups = shared.groups || !model.look.groups.of_face.empty();
    shared.objects = shared.objects || !model.look.objects.of_face.empty();
  }
  return shared;
}

/// With the numbers of the collected lists.
Mesh like_the_others(const Mesh& model, const Shared& shared, LookCollector& looks) {
  Mesh made = model;
  looks.take(model.look);
  made.look = {};
  for (std::size_t face = 0; face < model.face_count(); ++face) {
    const FaceLook look = looks.look_of(model.look, face);
    if (shared.materials) made.look.face_materials.push_back(look.material);
    if (shared.groups) made.look.groups.of_face.push_back(look.group);
    if (shared.objects) made.look.objects.of_face.push_back(look.object);
  }
  made.look.vertex_colours = model.look.vertex_colours;
  made.look.texcoord_colours = model.look.texcoord_colours;
  if ((shared.colours || shared.corner_colours) && !made.look.has_colours())
    made.look.vertex_colours = Eigen::Matrix4Xf::Ones(4, model.vertices.cols());
  if (shared.corner_colours) move_colours_to_corners(made);
  if (shared.texture && made.corner_texcoords.empty()) {
    made.texcoords = Eigen::Matrix2Xd::Zero(2, 1);
    made.corner_texcoords.assign(model.face_corners.size(), 0);
  }
  return made;
}

bool is_empty(const Box& box) {
  return !(box.lowest.x() <= box.highest.x());
}

/// How each model moves, which the first does not.
std::vector<Eigen::Vector3d> ways_of(std::span<const Mesh> models) {
  std::vector<Box> boxes;
  double widest = 0.0;
  for (const Mesh& model : models) {
    boxes.push_back(finite_box_of(model.vertices));
    if (!is_empty(boxes.back()))
      widest = std::max(widest, boxes.back().highest.x() - boxes.back().lowest.x());
  }
  std::vector<Eigen::Vector3d> ways(models.size(), Eigen::Vector3d::Zero());
  const Box* before = nullptr;
  double right = 0.0; // of the one before
  for (std::size_t at = 0; at < models.size(); ++at) {
    const Box& box = boxes[at];
    if (is_empty(box)) continue;
    if (before != nullptr)
      ways[at] = {right + gap_of_width * widest - box.lowest.x(),
                  before->lowest.y() - box.lowest.y(), before->highest.z() - box.highest.z()};
    else
      before = &box;
    right = box.highest.x() + ways[at].x();
  }
  return ways;
}

} // namespace

Result<Mesh> side_by_side(std::span<const Mesh> models) {
  Mesh all;
  if (!models.empty()) all.offset = models.front().offset;
  LookCollector looks(all.look);
  const Shared shared = shared_by(models);
  const std::vector<Eigen::Vector3d> ways = ways_of(models);
  for (std::size_t at = 0; at < models.size(); ++at) {
    Mesh model = like_the_others(models[at], shared, looks);
    if (!fit_together(all, model)) return Error{Errc::bad_input, "are too large together"};
    if (!ways[at].isZero(0.0)) model.vertices.colwise() += ways[at];
    append_mesh(model, all);
  }
  return all;
}

} // namespace nendo::deform
