#include "geometry/exact_predicates.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace nendo::deform {
namespace {

constexpr double half_ulp = std::numeric_limits<double>::epsilon() / 2.0;
// Bounds of the rounding error of a determinant in plain doubles, as parts of the sum of its terms'
// sizes (Shewchuk 1997, section 4).
constexpr double orient_2d_bound = (3.0 + 16.0 * half_ulp) * half_ulp;
constexpr double orient_3d_bound = (7.0 + 56.0 * half_ulp) * half_ulp;
constexpr double in_circle_bound = (10.0 + 96.0 * half_ulp) * half_ulp;

/// value + error is the result, exactly.
struct Rounded {
  double value, error;
};

Rounded two_sum(double a, double b) noexcept {
  const double sum = a + b;
  const double part = sum - a;
  return {sum, (a - (sum - part)) + (b - part)};
}

Rounded two_product(double a, double b) noexcept {
  const double product = a * b;
#ifdef FP_FAST_FMA
  return {product, std::fma(a, b, -product)};
#else
  constexpr double splitter = 134217729.0; // 2^27 + 1
  const auto high_of = [](double value) {
    const double scaled = splitter * value;
    return scaled - (scaled - value);
  };
  const double a_high = high_of(a);
  const double b_high = high_of(b);
  const double a_low = a - a_high;
  const double b_low = b - b_high;
  return {product,
          a_low * b_low - (((product - a_high * b_high) - a_low * b_high) - a_high * b_low)};
#endif
}

/// An exact number: the sum of its terms, which grow in size and do not overlap. None is zero.
template <std::size_t N>
struct Expansion {
  std::array<double, N> terms;
  std::size_t count = 0;

  void append(double term) noexcept {
    if (term != 0.0) terms[count++] = term;
  }
  int sign() const noexcept { return count == 0 ? 0 : terms[count - 1] > 0.0 ? 1 : -1; }
};

Expansion<2> difference(double a, double b) noexcept {
  const Rounded rounded = two_sum(a, -b);
  Expansion<2> exact;
  exact.append(rounded.error);
  exact.append(rounded.value);
  return exact;
}

template <std::size_t N>
Expansion<N> negated(Expansion<N> value) noexcept {
  for (std::size_t at = 0; at < value.count; ++at)
    value.terms[at] = -value.terms[at];
  return value;
}

/// Writes a + b, which must have space for all terms of both.
template <std::size_t N, std::size_t M, std::size_t Capacity>
void add_to(const Expansion<N>& a, const Expansion<M>& b, Expansion<Capacity>& sum) noexcept {
  sum.count = 0;
  std::size_t at = 0;
  std::size_t bt = 0;
  double carry = 0.0;
  while (at < a.count || bt < b.count) {
    const bool take_a =
        bt == b.count || (at < a.count && std::abs(a.terms[at]) < std::abs(b.terms[bt]));
    const Rounded rounded = two_sum(carry, take_a ? a.terms[at++] : b.terms[bt++]);
    sum.append(rounded.error);
    carry = rounded.value;
  }
  sum.append(carry);
}

template <std::size_t N, std::size_t M>
Expansion<N + M> plus(const Expansion<N>& a, const Expansion<M>& b) noexcept {
  Expansion<N + M> sum;
  add_to(a, b, sum);
  return sum;
}

template <std::size_t N>
Expansion<2 * N> scaled(const Expansion<N>& value, double factor) noexcept {
  Expansion<2 * N> result;
  double carry = 0.0;
  for (std::size_t at = 0; at < value.count; ++at) {
    const Rounded product = two_product(value.terms[at], factor);
    const Rounded low = two_sum(carry, product.error);
    result.append(low.error);
    const Rounded high = two_sum(product.value, low.value);
    result.append(high.error);
    carry = high.value;
  }
  result.append(carry);
  return result;
}

template <std::size_t N, std::size_t M>
Expansion<2 * N * M> times(const Expansion<N>& a, const Expansion<M>& b) noexcept {
  Expansion<2 * N * M> sum;
  Expansion<2 * N * M> next;
  for (std::size_t at = 0; at < b.count; ++at) {
    add_to(sum, scaled(a, b.terms[at]), next);
    sum.count = next.count;
    std::copy_n(next.terms.begin(), next.count, sum.terms.begin());
  }
  return sum;
}

/// Returns a * d - b * c.
Expansion<16> minor_of(const Expansion<2>& a, const Expansion<2>& b, const Expansion<2>& c,
                       const Expansion<2>& d) noexcept {
  return plus(times(a, d), negated(times(b, c)));
}

int exact_orient_2d(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c) noexcept {
  return minor_of(difference(a[0], c[0]), difference(a[1], c[1]), difference(b[0], c[0]),
                  difference(b[1], c[1]))
      .sign();
}

int exact_in_circle(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c,
                    const PlanePoint& d) noexcept {
  const std::array<const PlanePoint*, 3> corners{&a, &b, &c};
  std::array<std::array<Expansion<2>, 2>, 3> from;
  for (std::size_t k = 0; k < 3; ++k)
    from[k] = {difference((*corners[k])[0], d[0]), difference((*corners[k])[1], d[1])};
  const auto term = [&](std::size_t k) {
    const auto& next = from[(k + 1) % 3];
    const auto& last = from[(k + 2) % 3];
    return times(plus(times(from[k][0], from[k][0]), times(from[k][1], from[k][1])),
                 minor_of(next[0], next[1], last[0], last[1]));
  };
  return plus(plus(term(0), term(1)), term(2)).sign();
}

int exact_orient_3d(const SpacePoint& a, const SpacePoint& b, const SpacePoint& c,
                    const SpacePoint& d) noexcept {
  const std::array<const SpacePoint*, 3> corners{&a, &b, &c};
  std::array<std::array<Expansion<2>, 3>, 3> from;
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t axis = 0; axis < 3; ++axis)
      from[k][axis] = difference((*corners[k])[axis], d[axis]);
  const auto term = [&](std::size_t k) {
    const auto& next = from[(k + 1) % 3];
    const auto& last = from[(k + 2) % 3];
    return times(minor_of(next[0], next[1], last[0], last[1]), from[k][2]);
  };
  return plus(plus(term(0), term(1)), term(2)).sign();
}

int exact_turn_about(const SpacePoint& a, const SpacePoint& b, const SpacePoint& c,
                     const SpacePoint& normal) noexcept {
  const auto term = [&](std::size_t axis) {
    const std::size_t next = (axis + 1) % 3;
    const std::size_t last = (axis + 2) % 3;
    return scaled(minor_of(difference(b[next], a[next]), difference(b[last], a[last]),
                           difference(c[next], a[next]), difference(c[last], a[last])),
                  normal[axis]);
  };
  return plus(plus(term(0), term(1)), term(2)).sign();
}

} // namespace

int orient_2d(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c) noexcept {
  const double left = (a[0] - c[0]) * (b[1] - c[1]);
  const double right = (a[1] - c[1]) * (b[0] - c[0]);
  const double turn = left - right;
  if (std::abs(turn) > orient_2d_bound * (std::abs(left) + std::abs(right)))
    return turn > 0.0 ? 1 : -1;
  return exact_orient_2d(a, b, c);
}

int in_circle(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c,
              const PlanePoint& d) noexcept {
  const double ax = a[0] - d[0], ay = a[1] - d[1];
  const double bx = b[0] - d[0], by = b[1] - d[1];
  const double cx = c[0] - d[0], cy = c[1] - d[1];
  const double a_lift = ax * ax + ay * ay;
  const double b_lift = bx * bx + by * by;
  const double c_lift = cx * cx + cy * cy;
  const double value =
      a_lift * (bx * cy - cx * by) + b_lift * (cx * ay - ax * cy) + c_lift * (ax * by - bx * ay);
  const double size = a_lift * (std::abs(bx * cy) + std::abs(cx * by)) +
                      b_lift * (std::abs(cx * ay) + std::abs(ax * cy)) +
                      c_lift * (std::abs(ax * by) + std::abs(bx * ay));
  if (std::abs(value) > in_circle_bound * size) return value > 0.0 ? 1 : -1;
  return exact_in_circle(a, b, c, d);
}

int orient_3d(const SpacePoint& a, const SpacePoint& b, const SpacePoint& c,
              const SpacePoint& d) noexcept {
  const double ax = a[0] - d[0], ay = a[1] - d[1], az = a[2] - d[2];
  const double bx = b[0] - d[0], by = b[1] - d[1], bz = b[2] - d[2];
  const double cx = c[0] - d[0], cy = c[1] - d[1], cz = c[2] - d[2];
  const double value =
      az * (bx * cy - cx * by) + bz * (cx * ay - ax * cy) + cz * (ax * by - bx * ay);
  const double size = std::abs(az) * (std::abs(bx * cy) + std::abs(cx * by)) +
                      std::abs(bz) * (std::abs(cx * ay) + std::abs(ax * cy)) +
                      std::abs(cz) * (std::abs(ax * by) + std::abs(bx * ay));
  if (std::abs(value) > orient_3d_bound * size) return value > 0.0 ? 1 : -1;
  return exact_orient_3d(a, b, c, d);
}

int turn_about(const SpacePoint& a, const SpacePoint& b, const SpacePoint& c,
               const SpacePoint& normal) noexcept {
  const double bx = b[0] - a[0], by = b[1] - a[1], bz = b[2] - a[2];
  const double cx = c[0] - a[0], cy = c[1] - a[1], cz = c[2] - a[2];
  const double value = normal[0] * (by * cz - bz * cy) + normal[1] * (bz * cx - bx * cz) +
                       normal[2] * (bx * cy - by * cx);
  const double size = std::abs(normal[0]) * (std::abs(by * cz) + std::abs(bz * cy)) +
                      std::abs(normal[1]) * (std::abs(bz * cx) + std::abs(bx * cz)) +
                      std::abs(normal[2]) * (std::abs(bx * cy) + std::abs(by * cx));
  // The bound is that of orient_3d(), whose three factors are all rounded.
  if (std::abs(value) > orient_3d_bound * size) return value > 0.0 ? 1 : -1;
  return exact_turn_about(a, b, c, normal);
}

} // namespace nendo::deform
