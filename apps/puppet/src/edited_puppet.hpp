#pragma once
// A puppet while it is edited, for the functions of puppet_edit.hpp.

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include <nendo/puppet/puppet_edit.hpp>

namespace nendo::puppet {

/// The mirror image about x = at.
Eigen::Vector3d flipped(const Eigen::Vector3d& place, double at = 0.0);
AxisTurn flipped(const AxisTurn& turn); ///< about x = 0

/// A file is read by people: what the mouse gives has some three digits that mean anything, counted
/// from the radius, and `more` of them where another place must not be seen.
double rounded(double value, double radius, int more = 0);
Eigen::Vector3d rounded(const Eigen::Vector3d& vector, double radius, int more = 0);

/// An edit that cannot be.
Error refused(std::string message);

template <class List>
auto find_named(List& list, std::string_view name) {
  return std::ranges::find_if(list, [&](const auto& one) { return one.name == name; });
}

/// A puppet in the making, with its twins. The text brings them in line again.
class EditedPuppet {
public:
  explicit EditedPuppet(const Rig& rig) : puppet_(rig.puppet()), starts_(rig.starts()) {}

  Puppet& puppet() noexcept { return puppet_; }
  Eigen::Vector3d start(std::size_t point) const {
    return starts_.col(static_cast<Eigen::Index>(point));
  }

  Result<Puppet> done() const;

  /// The one whose mirror image it is, or itself.
  std::size_t source_of_point(std::size_t point) const;
  std::size_t twin_of_point(std::size_t point) const;
  std::size_t source_of_function(std::size_t function) const;
  /// A name that neither one of the list nor a twin has.
  template <class List>
  static std::string free_name(const List& list, const std::string& stem, bool is_left) {
    for (std::size_t number = 1;; ++number) {
      const std::string name = stem + std::to_string(number);
      const auto is_free = [&](const std::string& wanted) {
        return find_named(list, wanted) == list.end();
      };
      if (is_free(name) && is_free(name + "Left") && is_free(name + "Right"))
        return name + (is_left ? "Left" : "");
    }
  }
  bool is_moved(std::size_t point) const { return mover_of(point) != puppet_.functions.size(); }
  std::size_t mover_of(std::size_t point) const;

  /// Returns its number. What is clicked on the right side of a mirrored puppet is made on the
  /// left, whose twin is there.
  Result<std::size_t> add_point(const NewPoint& point, bool is_pin);
  bool is_sided(const NewPoint& point) const;
  /// Without the points of which `goes` is true.
  void remove_points(const std::vector<bool>& goes);

  static constexpr double middle =
      0.05; ///< fraction of the radius: nearer to x = 0, a point has no side

private:
  Puppet puppet_;
  const deform::Points& starts_;
};

} // namespace nendo::puppet
