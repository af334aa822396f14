#include <nendo/deform/type1.hpp>

#include <algorithm>
#include <array>
#include <cassert>
#include <cstdint>
#include <cstring>
#include <utility>
#include <vector>

#include "field/evaluator_parts.hpp"
#include "field/masked_step.hpp"
#include "history/sculpted_parts.hpp"
#include "simd/contact_kernels.hpp"
#include "simd/weight_kernels.hpp"
#include "solver/reserve_solver.hpp"

namespace nendo::deform {

namespace {

/// Weights that are smaller in a whole block are left out there: fingertips that are far from it
/// weigh something, because A^-1 is dense, but less with each one in between. A vertex loses at
/// most 1e-7 of the sum of the displacements.
constexpr float min_cardinal_weight = 1e-7F;
/// Pieces: with weights they take half as long as without.
constexpr std::size_t min_shared_pieces = 8;

constexpr int max_midpoint_steps = max_midpoint_fields / 2; // of a way: one and a half radii

std::size_t max_fields_of_type1(const DeformerOptions& options) {
  if (options.csrbf.keeps_volume()) return 2 * static_cast<std::size_t>(max_midpoint_steps);
  return options.injective ? static_cast<std::size_t>(options.injective->max_links) : 1;
}

} // namespace

/// The weights (simd/weight_kernels.hpp). They are built when the start points are frozen, and
/// applied each tick.
class CardinalWeights {
public:
  /// Allocates all memory that it will ever use: at most weight_bytes, and what the start points
  /// need. `field` must be as large as those that the solver makes.
  CardinalWeights(const BlockLayout& layout, Eigen::Index starts, CsrbfField field,
                  std::size_t weight_bytes);

  /// Makes the weights of the rest shape for the start points of `solver`, unless the memory does
  /// not suffice, or there are too many start points.
  void build(CsrbfSolver& solver, const BoundedShape& rest, BlockEvaluator& evaluator) noexcept;
  bool is_built() const noexcept { return built_; }
  std::size_t bytes_used() const noexcept {
    return cache_.used_bytes + cache_.used_entries * sizeof(WeightEntry);
  }

  /// Returns whether displacements (3 by #starts, model units) keep the rest shape finite.
  bool fits(const Points& displacements, const BoundedShape& rest) const noexcept;
  /// Computes to = rest + W displacements. The displacements must fit. `to` may be the rest's own
  /// blocks.
  void apply(const Points& displacements, const BlockShape& rest, BlockShape& to,
             BlockEvaluator& evaluator) noexcept;
  /// Updates the bounds of the rest shape. Call it after apply() has written to the rest shape
  /// itself.
  void update_rest_bounds(const Points& displacements, BoundedShape& rest) const noexcept;

private:
  bool solve_units(CsrbfSolver& solver) noexcept;
  void take_coefficients(Eigen::Index start, Eigen::Index axis) noexcept;
  double bound(const Points& displacements) const noexcept;

  Eigen::Vector3d origin_;
  double unit_;
  std::size_t starts_;
  Points unit_displacements_;
  CsrbfField unit_field_;
  std::vector<double> map_;
  std::vector<double> polynomial_;
  VectorArray<double> kernel_scratch_;
  std::size_t entries_;
  std::vector<WeightedBlock> blocks_;
  VectorArray<float> weight_scratch_;
  VectorArray<std::byte> weights_;
  std::vector<WeightEntry> weight_entries_;
  std::vector<std::uint8_t> reached_;
  std::vector<std::array<float, 4>> displacements_; ///< in units
  std::vector<std::array<float, 4>> steps_;         ///< those, times weight_step
  WeightCache cache_{};
  bool built_ = false;
  bool goes_back_ = false; ///< the next apply()
};

CardinalWeights::CardinalWeights(const BlockLayout& layout, Eigen::Index starts, CsrbfField field,
                                 std::size_t weight_bytes)
    : origin_(layout.origin()), unit_(layout.unit()), starts_(static_cast<std::size_t>(starts)),
      unit_displacements_(Points::Zero(3, starts)), unit_field_(std::move(field)),
      entries_(static_cast<std::size_t>(unit_field_.centres.cols())), displacements_(starts_),
      steps_(starts_) {
  const std::size_t blocks = layout.block_count();
  if (starts_ == 0 || starts_ > max_weighted_starts) return;
  const std::size_t max_entries =
      std::min(blocks * starts_, weight_bytes / (bytes_in_steps + sizeof(WeightEntry)));
  if (max_entries == 0) return;
  const std::size_t bytes =
      std::min(max_entries * bytes_in_float, weight_bytes - max_entries * sizeof(WeightEntry));
  map_.resize(entries_ * starts_);
  polynomial_.resize(4 * starts_);
  kernel_scratch_ = hwy::AllocateAligned<double>(block_size * entries_);
  weight_scratch_ = hwy::AllocateAligned<float>(block_size * starts_);
  blocks_.resize(blocks);
  weight_entries_.resize(max_entries);
  reached_.resize(blocks);
  weights_ = hwy::AllocateAligned<std::byte>(bytes);
  std::memset(weights_.get(), 0, bytes); // its pages are there now
  cache_ = {
      blocks_.data(), weight_entries_.data(), weights_.get(), max_entries, bytes, 0, 0, 0, 0.0};
}

/// The coefficients are linear in the displacements, and each axis is solved by itself: a unit for
/// three start points at a time, each on an axis of its own.
bool CardinalWeights::solve_units(CsrbfSolver& solver) noexcept {
  const auto starts = static_cast<Eigen::Index>(starts_);
  for (Eigen::Index first = 0; first < starts; first += 3) {
    const Eigen::Index count = std::min<Eigen::Index>(3, starts - first);
    unit_displacements_.setZero();
    for (Eigen::Index axis = 0; axis < count; ++axis)
      unit_displacements_(axis, first + axis) = 1.0;
    if (!is_solved(solver.solve(unit_displacements_, unit_field_))) return false;
    for (Eigen::Index axis = 0; axis < count; ++axis)
      take_coefficients(first + axis, axis);
  }
  return true;
}

void CardinalWeights::take_coefficients(Eigen::Index start, Eigen::Index axis) noexcept {
  const auto j = static_cast<std::size_t>(start);
  const double factor = kernel_factor(unit_field_.kernel);
  for (Eigen::Index entry = 0; entry < unit_field_.centres.cols(); ++entry)
    map_[static_cast<std::size_t>(entry) * starts_ + j] =
        factor * unit_field_.coefficients(axis, entry);
  const auto row = unit_field_.polynomial.row(axis);
  const Eigen::RowVector3d slope = row.rightCols<3>();
  polynomial_[4 * j] = row[0] + slope.dot(origin_);
  for (Eigen::Index k = 0; k < 3; ++k)
    polynomial_[4 * j + 1 + static_cast<std::size_t>(k)] = unit_ * slope[k];
}

void CardinalWeights::build(CsrbfSolver& solver, const BoundedShape& rest,
                            BlockEvaluator& evaluator) noexcept {
  built_ = false;
  cache_.used_entries = 0;
  cache_.used_bytes = 0;
  BlockEvaluator::Parts& parts = evaluator.parts();
  if (cache_.max_entries == 0 || !solve_units(solver) ||
      !parts.field.assign(unit_field_, BlockField::Zeros::kept))
    return;
  FieldView view = parts.field.view();
  view.precise_entries = parts.field.precise_entries();
  const bool global =
      std::any_of(polynomial_.begin(), polynomial_.end(), [](double p) { return p != 0.0; });
  const BlockPass pass{.from = rest.shape.data(),
                       .bounds = rest.bounds.data(),
                       .reached = reached_.data(),
                       .begin = 0,
                       .end = rest.shape.block_count(),
                       .scratch = parts.lists[0].scratch()};
  const WeightSource source{map_.data(),
                            global ? polynomial_.data() : nullptr,
                            starts_,
                            min_cardinal_weight,
                            kernel_scratch_.get(),
                            weight_scratch_.get()};
  built_ = build_weights(view, pass, source, cache_);
}

/// No coordinate moves farther.
double CardinalWeights::bound(const Points& displacements) const noexcept {
  return cache_.largest * displacements.cwiseAbs().rowwise().sum().maxCoeff() / unit_;
}

bool CardinalWeights::fits(const Points& displacements, const BoundedShape& rest) const noexcept {
  return displacements.cwiseAbs().maxCoeff() / unit_ <= max_units &&
         rest.extent + bound(displacements) <= max_units;
}

void CardinalWeights::apply(const Points& displacements, const BlockShape& rest, BlockShape& to,
                            BlockEvaluator& evaluator) noexcept {
  for (std::size_t j = 0; j < starts_; ++j) {
    const Eigen::Vector3f by =
        (displacements.col(static_cast<Eigen::Index>(j)) / unit_).cast<float>();
    displacements_[j] = {by[0], by[1], by[2], 0.0F};
    steps_[j] = {weight_step * by[0], weight_step * by[1], weight_step * by[2], 0.0F};
  }
  const std::uint64_t stamp = BlockShape::new_stamp();
  const bool large = leaves_caches(rest);
  const auto apply_piece = [&](std::size_t begin, std::size_t end) {
    apply_weights(cache_, {.by = displacements_.data(),
                           .by_step = steps_.data(),
                           .from = rest.data(),
                           .to = to.data(),
                           .begin = begin,
                           .end = end,
                           .large = large});
    for (std::size_t at = begin; at < end; ++at)
      to.set_stamp(blocks_[at].block, stamp);
  };
  // Back and forth: what is a little larger than a cache would, always read in one direction, never
  // be there when it is read again. Not with a second thread, which would get the other's half.
  const bool one_way = large || evaluator.parts().worker.has_value();
  const bool back = std::exchange(goes_back_, !goes_back_ && !one_way);
  const std::size_t blocks = cache_.block_count;
  evaluator.parts().in_pieces(
      blocks, min_shared_pieces, [&](std::size_t begin, std::size_t end, std::size_t) {
        for (std::size_t at = begin; at < end; at += blocks_per_piece) {
          const std::size_t until = std::min(at + blocks_per_piece, end);
          back ? apply_piece(blocks - until, blocks - at) : apply_piece(at, until);
        }
      });
  if (&rest == &to) return;
  for (std::size_t block = 0; block < rest.block_count(); ++block)
    if (reached_[block] == 0) to.follow(rest, block);
}

void CardinalWeights::update_rest_bounds(const Points& displacements,
                                         BoundedShape& rest) const noexcept {
  for (std::size_t at = 0; at < cache_.block_count; ++at) {
    const std::uint32_t block = blocks_[at].block;
    rest.bounds[block] = fast_bounds_of(rest.shape[block]);
  }
  rest.extent += bound(displacements);
}

Type1Deformer::Type1Deformer(Points rest, Eigen::Index control_points,
                             const DeformerOptions& options)
    : Type1Deformer(std::make_unique<SculptedShape>(std::move(rest), options), control_points,
                    options) {}

Type1Deformer::Type1Deformer(std::unique_ptr<SculptedShape> own, Eigen::Index control_points,
                             const DeformerOptions& options)
    : Type1Deformer(*own, control_points, options) {
  own_ = std::move(own);
}

Type1Deformer::Type1Deformer(SculptedShape& shape, Eigen::Index control_points,
                             const DeformerOptions& options)
    : shape_(&shape), starts_(Points::Zero(3, control_points)), rounded_(starts_),
      displacements_(starts_), asked_(starts_),
      supports_(rounded(options.supports, shape.layout())), solver_(options.csrbf),
      field_(zero_field(supports_, control_points, options.csrbf.kernel)),
      fields_(max_fields_of_type1(options), field_),
      evaluator_(std::make_unique<BlockEvaluator>(shape.layout(), field_.centres.cols(),
                                                  options.evaluation)),
      weights_(std::make_unique<CardinalWeights>(shape.layout(), control_points, field_,
                                                 options.csrbf.keeps_volume()
                                                     ? 0 // they would be matrices
                                                     : options.evaluation.weight_bytes)),
      masked_(std::make_unique<MaskedStep>(options.mask)) {
  if (options.csrbf.keeps_volume()) {
    steps_.emplace(control_points, supports_, options.csrbf, max_midpoint_steps);
    evaluator_->reserve_halves(shape.layout());
  } else if (options.injective) {
    chain_.emplace(control_points, supports_, options.csrbf, *options.injective);
  } else {
    reserve_solver(solver_, supports_, control_points);
    return;
  }
  // Not of the present shape, which another thread may be changing.
  linked_ = std::make_unique<BoundedShape>(shape.layout().pack());
}

Type1Deformer::~Type1Deformer() = default;
Type1Deformer::Type1Deformer(Type1Deformer&&) noexcept = default;
Type1Deformer& Type1Deformer::operator=(Type1Deformer&&) noexcept = default;

const BoundedShape& Type1Deformer::rest_shape() const noexcept {
  return shape_->parts().now;
}

FieldStatus Type1Deformer::grab(const Points& starts) {
  assert(starts.cols() == starts_.cols());
  const FieldStatus status = build(starts);
  if (is_solved(status)) take_hold();
  return status;
}

/// On failure everything is as it was.
FieldStatus Type1Deformer::build(const Points& starts) {
  for (Eigen::Index i = 0; i < starts.cols(); ++i)
    asked_.col(i) = shape_->layout().rounded(starts.col(i));
  const FieldStatus status = steps_   ? steps_->grab(asked_)
                             : chain_ ? chain_->grab(asked_)
                                      : solver_.build(asked_, supports_);
  if (!is_solved(status)) {
    // The failed build took the place of the good one.
    if (!steps_ && !chain_ && grabbed_ && status != FieldStatus::not_finite)
      solver_.build(rounded_, supports_);
    return status;
  }
  starts_ = starts;
  rounded_ = asked_;
  return status;
}

/// Of the rest shape, where the solver has been built for.
void Type1Deformer::take_hold() {
  grabbed_ = true;
  forget_applied();
  weights_->build(solver(), rest_shape(), *evaluator_);
}

FieldStatus Type1Deformer::apply(const Points& ends, BlockShape& out) {
  assert(ends.cols() == starts_.cols());
  if (grabbed_ && steps_) return apply_steps(ends, out);
  if (grabbed_ && chain_) return apply_links(ends, out);
  FieldStatus status = FieldStatus::singular;
  if (grabbed_) {
    asked_ = ends - starts_;
    status = solver_.solve(asked_, field_);
    const auto fits = [&] {
      return weights_->is_built() ? weights_->fits(asked_, rest_shape())
                                  : evaluator_->set_field(field_);
    };
    if (is_solved(status) && !fits()) {
      status = FieldStatus::not_finite;
      solver_.solve(displacements_, field_);
    }
    if (is_solved(status)) {
      displacements_ = asked_;
      fields_.clear();
      fields_.push(field_);
    }
  }
  draw(out);
  return status;
}

/// A single link is the plain field, for which there are weights.
FieldStatus Type1Deformer::apply_links(const Points& ends, BlockShape& out) {
  asked_ = rounded_ + (ends - starts_);
  FieldStatus status = chain_->from_start(asked_);
  if (is_solved(status)) {
    fields_.clear();
    const bool any = chain_->next();
    in_links_ = any && chain_->places() != asked_;
    if (in_links_) {
      status = follow_links(*chain_);
    } else {
      field_ = chain_->field();
      if (any) fields_.push(field_);
      displacements_ = asked_ - rounded_;
      while (chain_->next()) {
      }
    }
    status = std::max(status, chain_->report().status);
  }
  draw(out);
  return status;
}

/// On failure, the shape is the last good one.
FieldStatus Type1Deformer::apply_steps(const Points& ends, BlockShape& out) {
  asked_ = ends - starts_;
  FieldStatus status = steps_->go(asked_);
  if (is_solved(status)) {
    fields_.clear();
    displacements_ = asked_;
    in_links_ = steps_->next();
    if (in_links_) status = follow_links(*steps_);
    status = std::max(status, steps_->status());
  }
  draw(out);
  return status;
}

/// From the first, which is made.
template <class Chain>
FieldStatus Type1Deformer::follow_links(Chain& chain) {
  FieldStatus status = FieldStatus::ok;
  linked_->follow(rest_shape());
  do {
    const CsrbfField& link = chain.field();
    masked_->begin(linked_->shape);
    if (evaluator_->set_field(link) && evaluator_->displace(*linked_))
      fields_.push(link);
    else
      status = FieldStatus::not_finite;
    masked_->end(*linked_);
  } while (chain.next());
  return status;
}

void Type1Deformer::draw(BlockShape& out) {
  if (in_links_) {
    out.follow(linked_->shape);
    return;
  }
  const BlockShape& rest = rest_shape().shape;
  if (weights_->is_built()) {
    if (out.block_count() != rest.block_count()) out = rest;
    weights_->apply(displacements_, rest, out, *evaluator_);
  } else {
    evaluator_->set_field(field_);
    evaluator_->displace(rest_shape(), out);
  }
  if (is_masked()) masked_->mask()->apply(rest, out);
}

/// Makes the applied shape the rest shape.
void Type1Deformer::absorb() {
  BoundedShape& rest = shape_->parts().change();
  if (in_links_) {
    rest.follow(*linked_);
    return;
  }
  masked_->begin(rest.shape);
  if (weights_->is_built()) {
    weights_->apply(displacements_, rest.shape, rest.shape, *evaluator_);
    weights_->update_rest_bounds(displacements_, rest);
  } else {
    evaluator_->set_field(field_);
    evaluator_->displace(rest);
  }
  masked_->end(rest);
}

FieldStatus Type1Deformer::commit(const Points& ends) {
  assert(ends.cols() == starts_.cols());
  const FieldStatus status = build(ends);
  if (!is_solved(status)) return status;
  absorb();
  shape_->parts().keep();
  take_hold();
  return status;
}

void Type1Deformer::release(bool is_step) noexcept {
  if (grabbed_ && is_moved()) absorb();
  drop(is_step);
}

void Type1Deformer::drop(bool is_step) noexcept {
  if (is_step) shape_->parts().keep();
  grabbed_ = false;
  forget_applied();
}

void Type1Deformer::forget_applied() noexcept {
  in_links_ = false;
  displacements_.setZero();
  field_.coefficients.setZero();
  field_.polynomial.setZero();
  fields_.clear();
}

FieldStatus Type1Deformer::go(HistoryMove move, const Points& tips) {
  assert(tips.cols() == starts_.cols());
  if (move == HistoryMove::redo && shape_->redo_steps() == 0) return FieldStatus::ok;
  const FieldStatus status = build(tips);
  if (!is_solved(status)) return status;
  if (move == HistoryMove::reset && is_moved()) absorb();
  shape_->parts().go(move);
  take_hold();
  return status;
}

FieldStatus Type1Deformer::take_back(const Points& tips) {
  assert(tips.cols() == starts_.cols());
  const FieldStatus status = build(tips);
  if (!is_solved(status)) return status;
  SculptedShape::Parts& parts = shape_->parts();
  if (parts.history.is_kept()) {
    if (is_moved()) absorb();
    parts.history.keep_undone(parts.now, parts.note);
  }
  take_hold();
  return status;
}

bool Type1Deformer::is_masked() const noexcept {
  return masked_->mask() != nullptr;
}

std::size_t Type1Deformer::weight_bytes() const noexcept {
  return weights_->is_built() ? weights_->bytes_used() : 0;
}

} // namespace nendo::deform
