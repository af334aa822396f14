#pragma once
// What a ClayDeformer works with. All lengths are in the layout's coordinates.

#include <optional>
#include <span>
#include <vector>

#include <nendo/deform/clay.hpp>

#include "clay/contact_points.hpp"
#include "clay/contact_search.hpp"
#include "clay/grip.hpp"
#include "clay/impact_zones.hpp"
#include "clay/press_problem.hpp"
#include "clay/rigid_fit.hpp"
#include "clay/volume_keeper.hpp"
#include "field/block_evaluator.hpp"
#include "field/masked_step.hpp"

namespace nendo::deform {

class ClayDeformer::Work {
public:
  /// Allocates.
  Work(const SculptedShape& shape, std::span<const std::uint32_t> triangles, std::size_t bodies,
       std::size_t parts_per_body, const ClayOptions& options);

  /// Returns whether all numbers are usable. The number of parts must be the
  /// constructor's.
  bool accepts(std::span<const ContactPart> parts) const noexcept;
  /// Puts the bodies there, and takes the shape's volume as the one to keep.
  void take_hold(const BoundedShape& shape, std::span<const ContactPart> parts) noexcept;
  void continue_from(const Work& before, bool keeps_volume) noexcept;
  void release() noexcept {
    holds_ = false;
    contacts_.clear();
    volume_.forget(); // so that what comes does not depend on what was
  }
  std::span<const ClayContact> contacts() const noexcept { return contacts_; }
  double volume() const noexcept {
    return volume_now_ * layout_.unit() * layout_.unit() * layout_.unit();
  }
  bool holds() const noexcept { return holds_; }
  /// Moves the bodies and deforms the shape.
  void press(BoundedShape& shape, std::span<const ContactPart> parts, ClayReport& report) noexcept;

private:
  static constexpr double load_mm = 0.5;   ///< clay springs back by that
  static constexpr double max_bound = 0.9; ///< limit for a field that does not fold

  /// What was applied of a pass' field: only a part of it if all would fold.
  enum class Applied : std::uint8_t { nothing, part, whole };
  struct Found {
    double deepest = 0.0;
    bool is_loaded = false;
  };

  void pack(std::span<const ContactPart> parts, std::vector<ContactPart>& packed) const noexcept;
  std::size_t moving_bodies() const noexcept { return boxes_.size() - options_.still_bodies; }
  double way_to_target() const noexcept;
  bool is_way_free(const BoundedShape& shape) noexcept;
  void place_at(double share) noexcept;
  void drag(std::size_t part) noexcept;
  double sub_step(BoundedShape& shape, bool is_last, ClayReport& report) noexcept;
  double press_out(BoundedShape& shape, double enough, ClayReport& report) noexcept;
  void carry(BoundedShape& shape, ClayReport& report) noexcept;
  void pull(BoundedShape& shape, ClayReport& report) noexcept;
  bool pull_once(BoundedShape& shape) noexcept;
  void look_for_grips(ClayReport& report) noexcept;
  void leave_out_held(bool is_out) noexcept;
  bool holds_any() const noexcept;
  Found find(const BoundedShape& shape, bool loads) noexcept;
  void offer(const BoundedShape& shape, std::size_t body, std::size_t block,
             const NearestLanes& nearest, double& deepest) noexcept;
  Applied push(BoundedShape& shape, bool slides, ClayReport& report) noexcept;
  std::span<const ContactPoint> choose() noexcept;
  void slide(std::span<const ContactPoint> points) noexcept;
  Applied apply(BoundedShape& shape, std::span<const ContactPoint> points) noexcept;
  bool displace(BoundedShape& shape, Eigen::Index count) noexcept;
  void list_contacts() noexcept;
  void push_straight(BoundedShape& shape) noexcept;
  const NearestLanes& free_lanes(std::size_t block, const NearestLanes& all) noexcept;
  bool give_back(BoundedShape& shape, bool is_pressed, ClayReport& report) noexcept;
  bool is_coarse() const noexcept;
  double scale_to_volume(BoundedShape& shape, ClayReport& report) noexcept;
  void note_volume(double change, bool is_pressed, double most, ClayReport& report) noexcept;
  bool finish(BoundedShape& shape, ClayReport& report) noexcept;
  void put_off(double way, double volume, ClayReport& report) noexcept;

  const BlockLayout& layout_;
  ClayOptions options_;
  double mm_; ///< a millimetre
  double radius_;
  std::size_t parts_per_body_;
  bool holds_ = false;
  std::vector<ContactPart> from_, target_; ///< poses before and after a call
  std::vector<ContactPart> is_;            ///< poses in a sub-step
  std::vector<ContactPart> skins_;         ///< frames that lag behind the bones'
  std::vector<ContactPart> skins_before_;  ///< a call
  bool is_dragging_ = false;               ///< some skin has moved
  std::vector<Eigen::Isometry3d> ways_;    ///< the motion of each part's surface in a sub-step
  std::vector<BoxGate> boxes_;
  ContactSearch search_;
  ContactPoints chosen_;
  std::vector<ContactLoad> loads_;
  PressProblem problem_;
  std::vector<Friction> frictions_;
  std::vector<Grip> grips_; ///< one per body
  std::vector<Carrier> carriers_;
  HeldField pull_;
  Eigen::Isometry3d rigid_ = Eigen::Isometry3d::Identity(); ///< the model's motion in a sub-step
  CsrbfField field_;
  Eigen::Index used_ = 0; ///< columns of the field
  BlockEvaluator evaluator_;
  MaskedStep masked_;
  NearestLanes free_lanes_; ///< scratch for the function of that name
  VolumeKeeper volume_;
  std::optional<ImpactZones> zones_; ///< where the volume is kept
  double whole_volume_ = 0.0;
  double volume_now_ = 0.0;
  std::vector<std::vector<std::uint32_t>> deep_; ///< blocks in each body, by the last search
  std::vector<float> pressed_;                   ///< how deep each part came in this call
  std::vector<ClayContact> contacts_;
  bool is_settling_ = false; ///< some volume has not been given back yet
  bool swells_all_ = false;  ///< what is near the contacts did not suffice
  BoxGate around_;           ///< the contacts
  FieldStatus status_ = FieldStatus::ok;
};

/// Moves all vertices, with bounds and stamps.
template <class Move>
void move_vertices(BoundedShape& shape, const Move& move) noexcept {
  const std::uint64_t stamp = BlockShape::new_stamp();
  for (std::size_t block = 0; block < shape.bounds.size(); ++block) {
    VertexBlock& content = shape.shape.data()[block];
    for (std::size_t lane = 0; lane < block_size; ++lane)
      set_vertex(content, lane, move(vertex_in(content, lane)));
    shape.shape.set_stamp(block, stamp);
    shape.bounds[block] = bounds_of(content);
  }
}

} // namespace nendo::deform
