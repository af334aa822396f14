#include "render/scene.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <nendo/deform/mesh.hpp>

namespace nendo::render {

using Eigen::Vector3d;
using Eigen::Vector3f;

namespace {

// Linear colours. Clay is warm and the hands are grey, so that they differ at a
// glance, also without seeing red from green. A hand is solid, but one sees the model through it.
// That of a silent glove is a mere shade.
// The model's is its paint's.
const Material model{{}, 0.07F};
const Material skin{{0.33F, 0.345F, 0.37F}, 0.10F, 0.64F, 1.0F, 0.0F, 0.0F, true};
const Material silent_skin{{0.22F, 0.22F, 0.22F}, 0.0F, 0.25F, 0.85F};
const Material bone{{0.80F, 0.78F, 0.70F}, 0.10F};
const Material arrow{{0.95F, 0.52F, 0.02F}, 0.20F};
const Material wire{{0.15F, 0.15F, 0.17F}, 0.30F};
const Material reach{{0.80F, 0.40F, 0.05F}, 0.0F, 0.0F, 0.30F};
const Material ground{{0.74F, 0.74F, 0.74F}, 0.0F, 1.0F, 1.0F, 0.1F, 1.0F};

const std::array contact_colours{Material{{0.95F, 0.80F, 0.10F}, 0.10F},
                                 Material{{0.95F, 0.40F, 0.02F}, 0.10F},
                                 Material{{0.75F, 0.04F, 0.02F}, 0.10F}};

constexpr float arrow_width_m = 0.007F;
constexpr double ground_of_size = 2.6; // half its side, of the model's longest
constexpr int ground_cells = 96;

// Made when the first is drawn, for all of a program's scenes.
const HandSkin& skin_of(std::size_t slot) {
  static const std::array<HandSkin, 2> skins{HandSkin(Side::left), HandSkin(Side::right)};
  return skins[slot];
}
const HandSkin& coarse_skin_of(std::size_t slot) {
  constexpr float cell_m = HandSkin::coarse_cell_m;
  static const std::array<HandSkin, 2> skins{HandSkin(Side::left, cell_m),
                                             HandSkin(Side::right, cell_m)};
  return skins[slot];
}

} // namespace

std::vector<Vector3f> Scene::outline() const {
  std::vector<Vector3f> points = model.places;
  for (const auto* surfaces : {&solids, &veils})
    for (const Surface& surface : *surfaces)
      if (surface.material.opacity > 0.0F) // not how far a support reaches
        points.insert(points.end(), surface.places.begin(), surface.places.end());
  return points;
}

SceneBuilder::SceneBuilder(const deform::Mesh& rest, double units_per_metre)
    : units_per_metre_(units_per_metre) {
  const auto box = deform::box_of_faces(rest);
  const bool any = box.lowest[0] <= box.highest[0];
  // Halves, so that a model of any size has a finite one.
  const Vector3d half = any ? Vector3d(box.highest / 2 - box.lowest / 2) : Vector3d::Zero();
  const double longest = 2 * half.maxCoeff();
  if (!(units_per_metre_ > 0.0 && std::isfinite(units_per_metre_)))
    units_per_metre_ = longest > 0.0 && std::isfinite(longest)
                           ? longest / flow::PlacementOptions{}.model_size_m
                           : 1.0;
  size_m_ = 2 * (half / units_per_metre_);
  if (any) {
    origin_m_ = (box.lowest / 2 + box.highest / 2) / units_per_metre_;
    origin_m_.y() = box.lowest.y() / units_per_metre_;
  }
  paint_ = std::make_shared<const Paint>(rest, corners_);
  if (!rest.face_corners.empty()) any_corner_ = rest.face_corners.front();
  strays_ = deform::stray_vertices(rest);
}

void SceneBuilder::build(const SceneFrame& scene_frame, const SceneParts& parts,
                         Scene& scene) const {
  const auto count = static_cast<std::size_t>(scene_frame.vertices.cols());
  scene.model.places.resize(count);
  for (std::size_t at = 0; at < count; ++at)
    scene.model.places[at] =
        (scene_frame.vertices.col(static_cast<Eigen::Index>(at)) / units_per_metre_ - origin_m_)
            .cast<float>();
  for (const std::uint32_t stray : strays_)
    scene.model.places[stray] = scene.model.places[any_corner_];
  scene.model.corners = corners_;
  compute_normals(scene.model.places, corners_, scene.model.normals);
  build_beside(scene_frame, parts, scene);
  scene.grounds.clear();
  if (parts.ground) add_ground(scene, ground_cells);
}

void SceneBuilder::build_beside(const SceneFrame& scene_frame, const SceneParts& parts,
                                Scene& scene) const {
  scene.model.material = model;
  scene.model.paint = paint_;
  scene.solids.clear();
  scene.veils.clear();
  scene.grounds.clear();
  for (std::size_t slot = 0; slot < scene_frame.hands.size(); ++slot)
    if (scene_frame.hands[slot])
      add_hand(*scene_frame.hands[slot], slot, scene_frame, parts, scene);
  if (parts.contacts) add_contacts(scene_frame, scene);
  if (!scene_frame.wire.empty()) add_wire(scene_frame, scene);
  if (parts.ground) add_ground(scene, 1);
}

void SceneBuilder::add_hand(const SceneHand& hand, std::size_t slot, const SceneFrame& scene_frame,
                            const SceneParts& parts, Scene& scene) const {
  if (parts.bones) {
    scene.solids.push_back({{}, {}, {}, bone});
    add_bones(hand.pose, origin_m_, scene.solids.back());
  }
  if (parts.hands) {
    scene.veils.push_back({{}, {}, {}, hand.silent ? silent_skin : skin});
    const HandSkin& shape = parts.coarse_hands ? coarse_skin_of(slot) : skin_of(slot);
    shape.drape(hand.pose, origin_m_, scene.veils.back());
  }
  Surface arrows{{}, {}, {}, arrow};
  const auto tips = hand.pose.fingertip_positions();
  for (Eigen::Index finger = 0; finger < tips.cols(); ++finger) {
    const Vector3f start = (hand.starts.col(finger) - origin_m_).cast<float>();
    const Vector3f tip = (tips.col(finger) - origin_m_).cast<float>();
    if (parts.vectors && scene_frame.held) add_arrow(arrows, start, tip, arrow_width_m);
    const double radius = scene_frame.radius_m[static_cast<std::size_t>(finger)];
    if (!parts.radii || !scene_frame.held || !(radius > 0.0)) continue;
    scene.veils.push_back({{}, {}, {}, reach});
    add_sphere(scene.veils.back(), start, static_cast<float>(std::min(radius, 10.0)), 40);
  }
  if (!arrows.is_empty()) scene.solids.push_back(std::move(arrows));
}

// The harder a hand presses, the larger and the redder.
void SceneBuilder::add_contacts(const SceneFrame& scene_frame, Scene& scene) const {
  const auto longest = static_cast<float>(std::clamp(size_m_.maxCoeff(), 0.05, 0.3));
  std::array<Surface, contact_colours.size()> surfaces;
  for (const SceneContact& contact : scene_frame.contacts) {
    const auto colour =
        std::min(static_cast<std::size_t>(contact.strength * contact_colours.size()),
                 contact_colours.size() - 1);
    add_sphere(surfaces[colour], (contact.place_m - origin_m_).cast<float>(),
               longest * (0.010F + 0.015F * contact.strength), 10);
  }
  for (std::size_t colour = 0; colour < surfaces.size(); ++colour) {
    surfaces[colour].material = contact_colours[colour];
    if (!surfaces[colour].is_empty()) scene.solids.push_back(std::move(surfaces[colour]));
  }
}

// The wire as it is now, and what it has swept.
void SceneBuilder::add_wire(const SceneFrame& scene_frame, Scene& scene) const {
  constexpr float wire_radius_m = 0.0015F;
  const auto place_of = [&](const Eigen::Vector3d& place_m) -> Vector3f {
    return (place_m - origin_m_).cast<float>();
  };
  const deform::WirePlace& now = scene_frame.wire.back();
  scene.solids.push_back({{}, {}, {}, wire});
  add_capsule(scene.solids.back(), place_of(now.from), place_of(now.to), wire_radius_m,
              wire_radius_m);
  if (scene_frame.wire.size() < 2) return;
  Surface swept{{}, {}, {}, reach};
  for (std::size_t at = 0; at + 1 < scene_frame.wire.size(); ++at) {
    const Vector3f a = place_of(scene_frame.wire[at].from), b = place_of(scene_frame.wire[at].to),
                   c = place_of(scene_frame.wire[at + 1].to),
                   d = place_of(scene_frame.wire[at + 1].from);
    const Vector3f normal = (c - a).cross(d - b).normalized();
    const auto first = static_cast<std::uint32_t>(swept.places.size());
    swept.places.insert(swept.places.end(), {a, b, c, d});
    swept.normals.insert(swept.normals.end(), 4, normal);
    swept.corners.insert(swept.corners.end(),
                         {first, first + 1, first + 2, first, first + 2, first + 3});
  }
  scene.veils.push_back(std::move(swept));
}

// In so many cells along a side, for pictures know what light reaches it at its vertices.
void SceneBuilder::add_ground(Scene& scene, int cells) const {
  Surface surface{{}, {}, {}, ground};
  constexpr double without_model_m = 0.5;
  const double longest =
      corners_.empty() ? without_model_m : std::clamp(size_m_.maxCoeff(), 0.1, 2.0);
  const auto half = static_cast<float>(ground_of_size * longest);
  surface.material.fade_m = half;
  const float cell = 2.0F * half / static_cast<float>(cells);
  for (int row = 0; row <= cells; ++row)
    for (int column = 0; column <= cells; ++column)
      surface.places.emplace_back(static_cast<float>(column) * cell - half, 0.0F,
                                  static_cast<float>(row) * cell - half);
  surface.normals.assign(surface.places.size(), Vector3f::UnitY());
  const auto side = static_cast<std::uint32_t>(cells) + 1;
  for (std::uint32_t row = 0; row + 1 < side; ++row)
    for (std::uint32_t column = 0; column + 1 < side; ++column) {
      const std::uint32_t at = row * side + column;
      surface.corners.insert(surface.corners.end(),
                             {at, at + side, at + side + 1, at, at + side + 1, at + 1});
    }
  scene.grounds.push_back(std::move(surface));
}

void HoldTracker::follow(const flow::Frame& frame) noexcept {
  if (!watch_.follow(frame)) return;
  for (std::size_t slot = 0; slot < starts_.size(); ++slot)
    starts_[slot] = frame.hands[slot].pose.fingertip_positions();
}

void set_hands(const flow::Frame& frame, const HoldTracker& holds, SceneFrame& scene_frame) {
  const bool is_puppet = frame.function_count > 0; // which fingertips do not touch
  const bool is_by_hands = frame.clay.is_clay || frame.parts.count > 0; // whose tips hold nothing
  scene_frame.held = frame.held && !is_puppet && !is_by_hands;
  scene_frame.accumulates = frame.settings.mode == flow::Mode::type2;
  scene_frame.contacts.clear();
  for (const deform::ClayContact& contact : frame.contacts.all())
    scene_frame.contacts.push_back(
        {contact.place / frame.units_per_metre, flow::strength_of(contact)});
  scene_frame.wire.clear();
  if (frame.wire.is_drawing())
    for (const deform::WirePlace& place : frame.wire.places())
      scene_frame.wire.push_back(
          {place.from / frame.units_per_metre, place.to / frame.units_per_metre});
  for (std::size_t slot = 0; slot < scene_frame.hands.size(); ++slot) {
    const flow::HandFrame& hand = frame.hands[slot];
    scene_frame.hands[slot].reset();
    if (!hand.present) continue;
    scene_frame.hands[slot] = SceneHand{
        hand.pose, frame.held ? holds.starts(slot) : hand.pose.fingertip_positions(), hand.silent};
  }
}

} // namespace nendo::render
