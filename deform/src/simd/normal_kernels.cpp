// A field's value and its derivative at once: they share the distance.

#include "simd/normal_kernels.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd/normal_kernels.cpp"
#include "simd/targets.hpp"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "simd/few_centres-inl.hpp"
#include "simd/kernels-inl.hpp"
#include "simd/lists-inl.hpp"
#include "simd/tangents-inl.hpp"
#include "simd/turning-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace nendo::deform::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

template <Wendland kernel, class Real>
struct Turning {
  const FieldView& field;
  const FieldEntry<Real>* entries;
  const BlockPass& pass;
  const NormalPass& normals;

  HWY_INLINE void on_block(std::size_t block, const std::uint32_t* list, std::size_t size) {
    const bool moves = pass.to != nullptr;
    const bool reached = size > 0 || field.polynomial != nullptr;
    pass.reached[block] = reached ? 1 : 0;
    if (!reached) return;
    if (field.polynomial == nullptr && size == 1)
      return turn(block, [&](auto d, auto& at, std::size_t) HWY_ATTR {
        return turned_by_one<kernel>(d, moves, entries[list[0]], at);
      });
    if (field.polynomial == nullptr && size == 2)
      return turn(block, [&](auto d, auto& at, std::size_t) HWY_ATTR {
        return turned_by_two<kernel>(d, moves, entries[list[0]], entries[list[1]], at);
      });
    // All roots of the first centre together: they take longer than processors look ahead.
    alignas(64) Real distances[block_size];
    const hn::ScalableTag<Real> all;
    for (std::size_t lane = 0; size > 0 && lane < block_size; lane += hn::Lanes(all)) {
      const auto place = load_vectors(all, pass.from[block], lane);
      hn::Store(distance_to(all, entries[list[0]], place), all, distances + lane);
    }
    turn(block, [&](auto d, auto& at, std::size_t lane) HWY_ATTR {
      if (size > 0) at.distance = hn::Load(d, distances + lane);
      if (moves && field.polynomial != nullptr)
        at.sum = polynomial_at(d, *field.polynomial, at.place);
      return image_of(d, list, size, at);
    });
  }

  /// image(d, at, lane) is asked for each vector of a block's vertices, and adds to at.sum.
  template <class Image>
  HWY_INLINE void turn(std::size_t block, const Image& image) {
    const hn::ScalableTag<Real> d;
    const auto zero = hn::Zero(d);
    VertexBlock images;
    for (std::size_t lane = 0; lane < block_size; lane += hn::Lanes(d)) {
      TurningVector<hn::Vec<decltype(d)>> at{load_vectors(d, pass.from[block], lane),
                                             load_vectors(d, normals.from[block], lane),
                                             zero,
                                             {zero, zero, zero}};
      store_vectors(d, image(d, at, lane), images, lane);
      if (pass.to != nullptr) store_vectors(d, sum_of(at.place, at.sum), pass.to[block], lane);
    }
    normalise(images, normals.from[block], normals.to[block]);
  }

  template <class D, class V = hn::Vec<D>>
  HWY_INLINE Vectors3<V> image_of(D d, const std::uint32_t* list, std::size_t size,
                                  TurningVector<V>& at) {
    const bool moves = pass.to != nullptr;
    // Neighbours' normals are much alike: nearly all vectors have such a coordinate. For the usual
    // kernel alone, because each way takes its time to compile.
    if constexpr (kernel == Wendland::c2 && sizeof(Real) == sizeof(float)) {
      const V squared = dot(at.normal, at.normal);
      if (has_tangents(d, at.normal.z, squared))
        return add_tangents<kernel, 2>(d, moves, field, entries, list, size, at);
      if (has_tangents(d, at.normal.y, squared))
        return add_tangents<kernel, 1>(d, moves, field, entries, list, size, at);
      if (has_tangents(d, at.normal.x, squared))
        return add_tangents<kernel, 0>(d, moves, field, entries, list, size, at);
    }
    Gradients<V> columns{polynomial_along(d, field, 0), polynomial_along(d, field, 1),
                         polynomial_along(d, field, 2)};
    add_turning<kernel>(d, moves, entries, list, size, at, columns);
    return by_cofactors(columns, at.normal);
  }
};

template <Wendland kernel, class Real>
void turn_blocks(const FieldView& field, const FieldEntry<Real>* entries, const BlockPass& pass,
                 const NormalPass& normals) {
  Turning<kernel, Real> work{field, entries, pass, normals};
  for_each_block(field.centres, pass, work);
}

template <Wendland kernel>
void turn_with(const FieldView& field, const BlockPass& pass, const NormalPass& normals) {
  if (field.precise_entries != nullptr) {
    turn_blocks<kernel>(field, field.precise_entries, pass, normals);
  } else {
    turn_blocks<kernel>(field, field.entries, pass, normals);
  }
}

void turn_any(const FieldView& field, const BlockPass& pass, const NormalPass& normals) {
  switch (field.kernel) {
  case Wendland::c0:
    return turn_with<Wendland::c0>(field, pass, normals);
  case Wendland::c2:
    return turn_with<Wendland::c2>(field, pass, normals);
  case Wendland::c4:
    return turn_with<Wendland::c4>(field, pass, normals);
  case Wendland::c6:
    return turn_with<Wendland::c6>(field, pass, normals);
  }
}

} // namespace nendo::deform::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace nendo::deform {

HWY_EXPORT(turn_any);

void displace_normals_pass(const FieldView& field, const BlockPass& pass,
                           const NormalPass& normals) noexcept {
  HWY_DYNAMIC_DISPATCH(turn_any)(field, pass, normals);
}

} // namespace nendo::deform
#endif
