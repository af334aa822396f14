#pragma once
// A hand that grabs clay: two of its parts close on it from sides that face each other. What lies
// under them then follows them both ways, by a field, until they have opened. All lengths are in a
// layout's coordinates.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <nendo/deform/contact_part.hpp>

#include "clay/contact_points.hpp"

namespace nendo::deform {

/// A place of the clay that follows a part.
struct HeldPoint {
  std::uint32_t part = 0;
  Eigen::Vector3d local = Eigen::Vector3d::Zero(); ///< in the part's frame
  Eigen::Vector3d at = Eigen::Vector3d::Zero();    ///< the place of the clay
  Eigen::Vector3d goal = Eigen::Vector3d::Zero();  ///< where that shall go
};

/// Of one body. It belongs to one thread at a time and does not allocate but when it is made.
class Grip {
public:
  /// `first_part` is the body's first of all parts.
  Grip(std::size_t first_part, std::size_t parts, double mm);

  /// Takes note of a loaded place, once a call, between begin_look() and end_look().
  void begin_look() noexcept;
  void look(const ContactPoint& point, double load) noexcept;
  /// Ends the look and grabs or releases. `parts` are all parts with the frames that carry what
  /// is held. Returns true if that changed.
  bool end_look(std::span<const ContactPart> parts) noexcept;
  void release() noexcept;
  /// Holds what another grip of a body of as many parts holds, in coordinates that are `scale`
  /// times as large, with `origin` added.
  void take_over(const Grip& other, double scale, const Eigen::Vector3d& origin) noexcept;
  /// Sets the goals of the held places. Parts that open do not pull clay apart: they are not glued.
  void follow(std::span<const ContactPart> parts) noexcept;

  bool holds() const noexcept { return !held_.empty(); }
  bool holds(std::size_t part) const noexcept { return sides_[part - first_part_].is_held; }
  std::span<HeldPoint> held() noexcept { return held_; }

  /// No more places than this are held.
  static constexpr std::size_t max_held = 48;

private:
  static constexpr double min_closed_mm = 0.5;

  /// What a part presses.
  struct Side {
    double load = 0.0;
    Eigen::Vector3d place = Eigen::Vector3d::Zero(); ///< weighted by the loads, like the normal
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
    Eigen::Vector3d across = Eigen::Vector3d::Zero();        ///< to the parts that it faces
    Eigen::Isometry3d frame = Eigen::Isometry3d::Identity(); ///< in the call before
    double closes = 0.0; ///< how much nearer it came to what it faces, in this call
    double closed = 0.0; ///< and since it faces something
    bool is_held = false;

    /// A hand that only lies in the clay, between whose parts some is, does not hold it.
    bool has_closed(double mm) const noexcept { return closed > min_closed_mm * mm; }
  };
  struct Loaded {
    ContactPoint point;
    double load;
  };

  Eigen::Vector3d normal_along(std::size_t part, const Eigen::Vector3d& way) const noexcept;
  double gone(std::span<const ContactPart> parts, std::size_t side,
              const Eigen::Vector3d& way) const noexcept;
  bool find_facing(std::span<const ContactPart> parts) noexcept;
  void hold(const ContactPart& part, const ContactPoint& point, const Eigen::Vector3d& by) noexcept;
  void take(std::span<const ContactPart> parts) noexcept;
  Eigen::Vector3d across(std::span<const ContactPart> parts) const noexcept;

  std::size_t first_part_;
  double mm_;
  std::vector<Side> sides_;
  std::vector<Loaded> loaded_;
  std::vector<HeldPoint> held_;
  std::size_t held_side_ = 0; ///< points before this are of the first side
  double narrowest_ = 0.0;    ///< between the sides, since it grabbed
  int calls_ = 0;             ///< the calls during which the parts have faced, or been open
};

/// The CSRBF field that takes places along which are held, both ways:
///   s(x) = sum_i a_i psi(|x - c_i| / r), with (Psi + ridge) a = ways.
class HeldField {
public:
  /// Allocates for so many places.
  explicit HeldField(std::size_t most);

  void add(std::size_t at, const Eigen::Vector3d& place, const Eigen::Vector3d& way) noexcept;
  /// Solves for the first `count` places. Returns an L with |s(x) - s(y)| <= L |x - y|.
  double solve(std::size_t count, double radius) noexcept;
  Eigen::Vector3d place(std::size_t at) const noexcept { return column(places_, at); }
  Eigen::Vector3d coefficient(std::size_t at) const noexcept { return column(coefficients_, at); }
  /// Returns s there.
  Eigen::Vector3d field_at(const Eigen::Vector3d& place) const noexcept;

private:
  static Eigen::Vector3d column(const Eigen::Matrix3Xd& all, std::size_t at) noexcept {
    return all.col(static_cast<Eigen::Index>(at));
  }

  Eigen::Index count_ = 0;
  double radius_ = 1.0;
  Eigen::Matrix3Xd places_, ways_, coefficients_;
  Eigen::MatrixXd psi_, factor_;
};

} // namespace nendo::deform
