#include "deformer/cardinal_weights.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

#include "field/evaluator_parts.hpp"

namespace nendo::deform {

namespace {

/// Weights that are smaller in a whole block are left out there: fingertips that are far from it
/// weigh something, because A^-1 is dense, but less with each one in between. A vertex loses at
/// most 1e-7 of the sum of the displacements.
constexpr float min_cardinal_weight = 1e-7F;
/// Pieces: with weights they take half as long as without.
constexpr std::size_t min_shared_pieces = 8;

} // namespace

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
    rest.bounds[block] = bounds_of(rest.shape[block]);
  }
  rest.extent += bound(displacements);
}

} // namespace nendo::deform
