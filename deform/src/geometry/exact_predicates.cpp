#include "geometry/exact_predicates.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "geometry/space.hpp"

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

/// Returns the sign of the determinant whose rows are x, y and third(point, {x, y}) of three
/// points, relative to `from`.
template <class Point, class Third>
int exact_sign(const std::array<const Point*, 3>& points, const Point& from,
               const Third& third) noexcept {
  std::array<std::array<Expansion<2>, 2>, 3> rows;
  for (std::size_t k = 0; k < 3; ++k)
    rows[k] = {difference((*points[k])[0], from[0]), difference((*points[k])[1], from[1])};
  const auto term = [&](std::size_t k) {
    const auto& next = rows[(k + 1) % 3];
    const auto& last = rows[(k + 2) % 3];
    return times(minor_of(next[0], next[1], last[0], last[1]), third(*points[k], rows[k]));
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

/// Returns the sign of the determinant with these rows: exact() if rounding could change it, which
/// is by at most `bound` of the sum of its terms' sizes.
template <class Exact>
int sign_of(const SpacePoint& a, const SpacePoint& b, const SpacePoint& c, double bound,
            const Exact& exact) noexcept {
  const double value = a[2] * (b[0] * c[1] - c[0] * b[1]) + b[2] * (c[0] * a[1] - a[0] * c[1]) +
                       c[2] * (a[0] * b[1] - b[0] * a[1]);
  const double size = std::abs(a[2]) * (std::abs(b[0] * c[1]) + std::abs(c[0] * b[1])) +
                      std::abs(b[2]) * (std::abs(c[0] * a[1]) + std::abs(a[0] * c[1])) +
                      std::abs(c[2]) * (std::abs(a[0] * b[1]) + std::abs(b[0] * a[1]));
  if (std::abs(value) > bound * size) return value > 0.0 ? 1 : -1;
  return exact();
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
  const auto lifted = [&](const PlanePoint& point) {
    const double x = point[0] - d[0], y = point[1] - d[1];
    return SpacePoint{x, y, x * x + y * y};
  };
  return sign_of(lifted(a), lifted(b), lifted(c), in_circle_bound, [&] {
    return exact_sign<PlanePoint>({&a, &b, &c}, d, [](const PlanePoint&, const auto& row) {
      return plus(times(row[0], row[0]), times(row[1], row[1]));
    });
  });
}

int orient_3d(const SpacePoint& a, const SpacePoint& b, const SpacePoint& c,
              const SpacePoint& d) noexcept {
  return sign_of(a - d, b - d, c - d, orient_3d_bound, [&] {
    return exact_sign<SpacePoint>({&a, &b, &c}, d, [&](const SpacePoint& point, const auto&) {
      return difference(point[2], d[2]);
    });
  });
}

int turn_about(const SpacePoint& a, const SpacePoint& b, const SpacePoint& c,
               const SpacePoint& normal) noexcept {
  // The bound is that of orient_3d(), whose three factors are all rounded.
  return sign_of(b - a, c - a, normal, orient_3d_bound,
                 [&] { return exact_turn_about(a, b, c, normal); });
}

} // namespace nendo::deform
