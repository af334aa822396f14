#include <nendo/deform/part_mover.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Geometry>

#include <nendo/deform/vertex_mask.hpp>

#include "cut/cut_assembly.hpp"
#include "history/sculpted_parts.hpp"

namespace nendo::deform {
namespace {

using Eigen::Isometry3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using Eigen::Vector3f;

/// A hand's frame now, and when this or another hand took the part.
struct HeldFrame {
  Isometry3d from, now;
};

bool stays(const HeldFrame& hand) noexcept {
  return hand.now.matrix() == hand.from.matrix();
}

/// By which angle a rotation turns about an axis, the rest being turns of the axis itself.
double angle_about(const Vector3d& axis, const Quaterniond& turn) noexcept {
  return 2.0 * std::atan2(turn.vec().dot(axis), turn.w());
}

Quaterniond turn_of(const HeldFrame& hand) noexcept {
  return Quaterniond(hand.now.linear() * hand.from.linear().transpose()).normalized();
}

/// Within half a turn.
double near_zero(double angle) noexcept {
  return std::remainder(angle, 2.0 * std::numbers::pi);
}

/// The shortest rotation from one direction to another. Eigen's Quaternion::FromTwoVectors() is the
/// same, but for opposite directions it has a singular value decomposition, which takes ten seconds
/// to compile.
Quaterniond rotation_between(const Vector3d& before, const Vector3d& after) noexcept {
  const Vector3d from = before.normalized(), to = after.normalized();
  const double cosine = to.dot(from);
  if (cosine < -1.0 + Eigen::NumTraits<double>::dummy_precision())
    return Quaterniond(Eigen::AngleAxisd(std::numbers::pi, from.unitOrthogonal()));
  const double twice_real = std::sqrt((1.0 + cosine) * 2.0);
  Quaterniond rotation;
  rotation.vec() = from.cross(to) * (1.0 / twice_real);
  rotation.w() = 0.5 * twice_real;
  return rotation;
}

Quaterniond turn_of_two(const HeldFrame& one, const HeldFrame& other) noexcept {
  const Vector3d before = other.from.translation() - one.from.translation();
  const Vector3d after = other.now.translation() - one.now.translation();
  const Quaterniond first = turn_of(one), second = turn_of(other);
  if (!(before.norm() > 0.0) || !(after.norm() > 0.0)) return first.slerp(0.5, second);
  const Vector3d axis = after.normalized();
  const Quaterniond along = rotation_between(before, after);
  const double of_first = near_zero(angle_about(axis, first * along.conjugate()));
  const double of_second = near_zero(angle_about(axis, second * along.conjugate()));
  // From the one to the other on the shorter way.
  const double mean = of_first + 0.5 * near_zero(of_second - of_first);
  return Quaterniond(Eigen::AngleAxisd(mean, axis)) * along;
}

/// Returns the motion of a part that one hand or two hold. With two, the middle and the line
/// between them follow the hands; about the line the part turns by the mean of the hands' turns. If
/// no frame has changed, it is the identity, bit for bit. Wait-free.
Isometry3d motion_of(std::span<const HeldFrame> hands) noexcept {
  if (std::all_of(hands.begin(), hands.end(), stays)) return Isometry3d::Identity();
  if (hands.size() == 1) return hands[0].now * hands[0].from.inverse();
  const Vector3d from = 0.5 * (hands[0].from.translation() + hands[1].from.translation());
  const Vector3d now = 0.5 * (hands[0].now.translation() + hands[1].now.translation());
  Isometry3d motion = Isometry3d::Identity();
  motion.linear() = turn_of_two(hands[0], hands[1]).toRotationMatrix();
  motion.translation() = now - motion.linear() * from;
  return motion;
}

/// Parts may be put so many units of the layout away: float is precise enough there.
constexpr double farthest = 1e4;

float square_from(const BlockBounds& bounds, const Vector3f& point) noexcept {
  const Eigen::Map<const Vector3f> low(bounds.sides.data()), high(bounds.sides.data() + 4);
  return (low - point).cwiseMax(point + high).cwiseMax(0.0F).squaredNorm();
}

std::vector<bool> held_down(const ModelParts& parts, const VertexMask* mask) {
  std::vector<bool> down(parts.count(), false);
  if (mask == nullptr) return down;
  for (std::uint32_t part = 0; part < parts.count(); ++part)
    for (const ModelParts::Block& block : parts.blocks_of(part))
      if (const float* weights = mask->of_block(block.number))
        block.each_lane([&](std::size_t lane) { down[part] = down[part] || weights[lane] < 0.5F; });
  return down;
}

} // namespace

class PartMover::Work {
public:
  Work(const SculptedShape& shape, std::shared_ptr<const ModelParts> parts,
       const PartMoverOptions& options)
      : layout_(shape.layout()), parts_(std::move(parts)),
        reach_(static_cast<float>(options.reach / layout_.unit())),
        is_down_(held_down(*parts_, options.mask.get())), hands_(options.hands),
        base_(layout_.block_count()), held_frames_(options.hands) {}

  bool accepts(std::span<const PartGrip> grips) const noexcept {
    return grips.size() == hands_.size() &&
           std::all_of(grips.begin(), grips.end(), [&](const PartGrip& grip) {
             return grip.frame.matrix().allFinite() &&
                    (grip.frame.translation() - layout_.origin()).cwiseAbs().maxCoeff() <=
                        farthest * layout_.unit();
           });
  }
  bool holds() const noexcept { return holds_; }
  bool is_moved() const noexcept { return is_moved_; }
  std::uint32_t held_by(std::size_t hand) const noexcept { return hands_[hand].part; }
  std::uint32_t in_reach_of(std::size_t hand) const noexcept { return hands_[hand].in_reach; }

  void take_hold(const BoundedShape& shape, std::span<const PartGrip> grips) noexcept {
    holds_ = true;
    for (const Hand& hand : hands_)
      if (hand.part != no_index) restart(hand.part, shape.shape, grips);
  }
  void release() noexcept {
    holds_ = is_moved_ = false;
    std::fill(hands_.begin(), hands_.end(), Hand{});
  }

  void move(SculptedShape::Parts& shape, std::span<const PartGrip> grips) noexcept {
    is_moved_ = false;
    for (std::size_t hand = 0; hand < hands_.size(); ++hand)
      follow_grip(hand, shape.now, grips);
    for (std::size_t hand = 0; hand < hands_.size(); ++hand) {
      const std::uint32_t part = hands_[hand].part;
      if (part != no_index && first_holder(part) == hand) move_part(part, shape, grips);
    }
  }

private:
  struct Hand {
    std::uint32_t part = no_index;
    std::uint32_t in_reach = no_index;
    bool was_closed = false;
    Isometry3d from = Isometry3d::Identity(); ///< its frame when base_ was as it is
    Isometry3d last = Isometry3d::Identity(); ///< the part's motion, of the first that holds it
  };

  std::size_t first_holder(std::uint32_t part) const noexcept {
    const auto found = std::find_if(hands_.begin(), hands_.end(),
                                    [&](const Hand& hand) { return hand.part == part; });
    return static_cast<std::size_t>(found - hands_.begin());
  }

  void follow_grip(std::size_t number, const BoundedShape& shape,
                   std::span<const PartGrip> grips) noexcept {
    Hand& hand = hands_[number];
    const bool is_closed = grips[number].is_closed;
    const bool was_closed = std::exchange(hand.was_closed, is_closed);
    hand.in_reach =
        is_closed && was_closed ? no_index : part_at(shape, grips[number].frame.translation());
    if (is_closed && !was_closed) {
      hand.part = std::exchange(hand.in_reach, no_index);
      if (hand.part != no_index) restart(hand.part, shape.shape, grips);
    } else if (!is_closed && hand.part != no_index) {
      const std::uint32_t part = std::exchange(hand.part, no_index);
      restart(part, shape.shape, grips); // for the other hand
    }
  }

  /// The part whose vertex is nearest; no_index if it is beyond reach, or held down.
  std::uint32_t part_at(const BoundedShape& shape, const Vector3d& point) const noexcept {
    const Vector3f at = ((point - layout_.origin()) / layout_.unit()).cast<float>();
    float least = std::numeric_limits<float>::infinity();
    std::uint32_t part = no_index;
    for (std::size_t block = 0; block < shape.bounds.size(); ++block) {
      if (square_from(shape.bounds[block], at) >= least) continue;
      const VertexBlock& content = shape.shape[block];
      const std::size_t end = std::min(layout_.vertex_count(), (block + 1) * block_size);
      for (std::size_t place = block * block_size; place < end; ++place) {
        const float square = (vertex_in(content, place % block_size) - at).squaredNorm();
        if (square >= least || parts_->at_place(place) == no_index) continue;
        least = square;
        part = parts_->at_place(place);
      }
    }
    if (part == no_index || is_down_[part]) return no_index;
    return least <= reach_ * reach_ || is_in_box(shape, part, at) ? part : no_index;
  }

  bool is_in_box(const BoundedShape& shape, std::uint32_t part, const Vector3f& at) const noexcept {
    Eigen::AlignedBox3f box;
    for (const ModelParts::Block& block : parts_->blocks_of(part)) { // at most as large
      const auto& sides = shape.bounds[block.number].sides;
      box.extend(Vector3f(sides[0], sides[1], sides[2]));
      box.extend(-Vector3f(sides[4], sides[5], sides[6]));
    }
    if (!box.contains(at)) return false; // as in most ticks
    box.setEmpty();
    for (const ModelParts::Block& block : parts_->blocks_of(part))
      block.each_lane(
          [&](std::size_t lane) { box.extend(vertex_in(shape.shape[block.number], lane)); });
    return box.contains(at);
  }

  /// What holds the part moves it from here.
  void restart(std::uint32_t part, const BlockShape& shape,
               std::span<const PartGrip> grips) noexcept {
    for (std::size_t hand = 0; hand < hands_.size(); ++hand)
      if (hands_[hand].part == part) {
        hands_[hand].from = grips[hand].frame;
        hands_[hand].last = Isometry3d::Identity();
      }
    for (const ModelParts::Block& block : parts_->blocks_of(part))
      block.each_lane([&](std::size_t lane) {
        set_vertex(base_[block.number], lane, vertex_in(shape[block.number], lane));
      });
  }

  void move_part(std::uint32_t part, SculptedShape::Parts& shape,
                 std::span<const PartGrip> grips) noexcept {
    std::size_t holders = 0;
    for (std::size_t hand = 0; hand < hands_.size(); ++hand)
      if (hands_[hand].part == part)
        held_frames_[holders++] = {hands_[hand].from, grips[hand].frame};
    const Isometry3d motion = motion_of({held_frames_.data(), holders});
    Isometry3d& last = hands_[first_holder(part)].last;
    if (motion.matrix() == last.matrix()) return;
    last = motion;
    write(part, motion, shape.change());
    is_moved_ = true;
  }

  /// Into coordinates of the layout: there, x becomes R x + (R o + t - o) / unit.
  void write(std::uint32_t part, const Isometry3d& motion, BoundedShape& shape) noexcept {
    const Vector3d& origin = layout_.origin();
    const Eigen::Matrix3f turn = motion.linear().cast<float>();
    const Vector3f way = ((motion * origin - origin) / layout_.unit()).cast<float>();
    const std::uint64_t stamp = BlockShape::new_stamp();
    for (const ModelParts::Block& block : parts_->blocks_of(part)) {
      VertexBlock& to = shape.shape.data()[block.number];
      block.each_lane([&](std::size_t lane) {
        set_vertex(to, lane, turn * vertex_in(base_[block.number], lane) + way);
      });
      const std::size_t first = block.number * block_size;
      repeat_last(to, std::min(layout_.vertex_count() - first, block_size));
      shape.shape.set_stamp(block.number, stamp);
      shape.bounds[block.number] = bounds_of(to);
      for (const float side : shape.bounds[block.number].sides)
        shape.extent = std::max(shape.extent, std::abs(static_cast<double>(side)));
    }
  }

  const BlockLayout& layout_;
  std::shared_ptr<const ModelParts> parts_;
  float reach_; ///< in coordinates of the layout
  std::vector<bool> is_down_;
  std::vector<Hand> hands_;
  std::vector<VertexBlock> base_; ///< what is held, as it was when it was taken
  std::vector<HeldFrame> held_frames_;
  bool holds_ = false;
  bool is_moved_ = false;
};

PartMover::PartMover(SculptedShape& shape, std::shared_ptr<const ModelParts> parts,
                     const PartMoverOptions& options)
    : shape_(&shape), work_(std::make_unique<Work>(shape, std::move(parts), options)) {}
PartMover::~PartMover() = default;
PartMover::PartMover(PartMover&&) noexcept = default;
PartMover& PartMover::operator=(PartMover&&) noexcept = default;

FieldStatus PartMover::begin(std::span<const PartGrip> grips) noexcept {
  if (!work_->accepts(grips)) return FieldStatus::not_finite;
  shape_->parts().keep();
  return grab(grips);
}

FieldStatus PartMover::grab(std::span<const PartGrip> grips) noexcept {
  if (!work_->accepts(grips)) return FieldStatus::not_finite;
  work_->take_hold(shape_->parts().now, grips);
  return FieldStatus::ok;
}

void PartMover::release(bool is_step) noexcept {
  if (is_step) shape_->parts().keep();
  work_->release();
}

FieldStatus PartMover::move_to(std::span<const PartGrip> grips) noexcept {
  if (!work_->holds()) return begin(grips);
  if (!work_->accepts(grips)) return FieldStatus::not_finite;
  work_->move(shape_->parts(), grips);
  return FieldStatus::ok;
}

FieldStatus PartMover::go(HistoryMove move, std::span<const PartGrip> grips) noexcept {
  if (move == HistoryMove::redo && shape_->redo_steps() == 0) return FieldStatus::ok;
  if (!work_->accepts(grips)) return FieldStatus::not_finite;
  shape_->parts().go(move);
  return grab(grips);
}

bool PartMover::is_moved() const noexcept {
  return work_->is_moved();
}

std::uint32_t PartMover::held_by(std::size_t hand) const noexcept {
  return work_->held_by(hand);
}

std::uint32_t PartMover::in_reach_of(std::size_t hand) const noexcept {
  return work_->in_reach_of(hand);
}

ModelParts::ModelParts(const Mesh& mesh, const BlockLayout& layout) {
  std::vector<std::uint32_t> of_vertex;
  const std::uint32_t count = number_parts(mesh, of_vertex);
  of_place_.reserve(layout.vertex_count());
  for (const std::uint32_t vertex : layout.order())
    of_place_.push_back(of_vertex[vertex]);

  std::vector<std::vector<Block>> blocks(count);
  for (std::size_t place = 0; place < of_place_.size(); ++place) {
    if (of_place_[place] == no_index) continue;
    auto& of_part = blocks[of_place_[place]];
    const auto number = static_cast<std::uint32_t>(place / block_size);
    if (of_part.empty() || of_part.back().number != number) of_part.push_back({number, 0});
    of_part.back().lanes |= std::uint64_t{1} << (place % block_size);
  }
  starts_.assign(1, 0);
  for (const auto& of_part : blocks) {
    blocks_.insert(blocks_.end(), of_part.begin(), of_part.end());
    starts_.push_back(blocks_.size());
  }
}

} // namespace nendo::deform
