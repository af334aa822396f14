#include "join/refine.hpp"

#include <algorithm>
#include <compare>

namespace nendo::deform {
namespace {

/// An edge by its ends, since its number changes, the lesser first.
struct RefineEdge {
  double order; ///< the least is taken first
  std::uint32_t from, to;
  auto operator<=>(const RefineEdge&) const = default;
};

bool is_near(const RefineZone& zone, std::uint32_t point) {
  return zone.coarseness[point] > 0.0f;
}

bool is_active(const RefineZone& zone, std::uint32_t point) {
  return zone.active.empty() || zone.active[point];
}

double coarseness_between(const RefineZone& zone, std::uint32_t a, std::uint32_t b) {
  const auto [least, most] = std::minmax(zone.coarseness[a], zone.coarseness[b]);
  return static_cast<double>(least > 0.0f ? least : most);
}

/// Calls visit(length, from, to) for each edge in the zone, with its length as the limits count it.
template <class Visit>
void visit_zone(const LiveSurface& surface, const RefineZone& zone, const Visit& visit) {
  for (std::uint32_t point = 0; point < surface.point_count(); ++point) {
    if (!is_near(zone, point) || !is_active(zone, point) || !surface.has_point(point)) continue;
    surface.visit_edges(point, [&](std::uint32_t edge) {
      const std::uint32_t other = surface.to(edge);
      if (is_near(zone, other) && is_active(zone, other) && other < point)
        return; // seen from there
      const auto [from, to] = std::minmax(point, other);
      visit(surface.edge_length(edge) / coarseness_between(zone, point, other), from, to);
    });
  }
}

/// Both ends hold.
bool is_fixed(const RefineZone& zone, std::uint32_t from, std::uint32_t to) {
  return zone.hold[from] == 2 && zone.hold[to] == 2;
}

class RefineRound {
public:
  RefineRound(LiveSurface& surface, RefineZone& zone, const RefineLimits& limits)
      : surface_(surface), zone_(zone), limits_(limits) {}

  RefineCounts run() {
    collect();
    split_long();
    if (!limits_.only_splits) {
      collapse_short();
      flip_all();
    }
    note_changes();
    return counts_;
  }

private:
  bool has_budget() const { return counts_.splits + counts_.collapses < limits_.budget; }

  void collect() {
    visit_zone(surface_, zone_, [&](double length, std::uint32_t from, std::uint32_t to) {
      if (length > limits_.longest) long_.push_back({-length, from, to});
      if (length < limits_.shortest) short_.push_back({length, from, to});
    });
    std::sort(long_.begin(), long_.end());
    std::sort(short_.begin(), short_.end());
  }
  void split_long() {
    for (const RefineEdge& wanted : long_) {
      if (!has_budget() || surface_.point_count() >= limits_.max_points) {
        ++counts_.left;
        continue;
      }
      surface_.split(surface_.edge_between(wanted.from, wanted.to));
      const float a = zone_.coarseness[wanted.from];
      const float b = zone_.coarseness[wanted.to];
      zone_.coarseness.push_back(a > 0.0f && b > 0.0f ? 0.5f * (a + b) : 0.0f);
      zone_.hold.push_back(0);
      if (!zone_.active.empty()) zone_.active.push_back(1);
      changed_.push_back(to_index(surface_.point_count() - 1));
      ++counts_.splits;
    }
  }
  bool may_go(std::uint32_t point, std::uint32_t into) const {
    return zone_.hold[point] < 2 && zone_.hold[point] <= zone_.hold[into];
  }
  /// Of two that hold alike, the greater number goes first.
  bool collapse(const RefineEdge& wanted) {
    std::uint32_t stays = wanted.from;
    std::uint32_t goes = wanted.to;
    for (int way = 0; way < 2; ++way, std::swap(stays, goes)) {
      if (!may_go(goes, stays)) continue;
      const std::uint32_t edge = surface_.edge_between(stays, goes);
      if (edge == no_index) return false;
      const double longest = limits_.longest * coarseness_between(zone_, stays, goes);
      if (surface_.collapse(edge, {longest, limits_.thin, limits_.min_cosine})) {
        changed_.push_back(stays);
        return true;
      }
    }
    return false;
  }
  void collapse_short() {
    for (const RefineEdge& wanted : short_) {
      if (!surface_.has_point(wanted.from) || !surface_.has_point(wanted.to)) continue;
      if (is_fixed(zone_, wanted.from, wanted.to)) continue;
      if (!has_budget()) {
        ++counts_.left;
        continue;
      }
      counts_.collapses += collapse(wanted) ? 1u : 0u;
    }
  }
  void flip_all() {
    for (std::uint32_t point = 0; point < surface_.point_count(); ++point) {
      if (!is_near(zone_, point) || !is_active(zone_, point) || !surface_.has_point(point))
        continue;
      around_.clear();
      surface_.visit_edges(point,
                           [&](std::uint32_t edge) { around_.push_back(surface_.to(edge)); });
      for (const std::uint32_t other : around_) {
        const std::uint32_t edge = surface_.edge_between(point, other);
        if (edge == no_index || !surface_.flip(edge)) continue;
        ++counts_.flips;
        changed_.insert(changed_.end(), {point, other});
      }
    }
  }

  /// Around what was changed, edges may have become unfit or unfair. What the budget left is there
  /// as well.
  void note_changes() {
    if (counts_.left > 0) return zone_.active.clear();
    zone_.active.assign(surface_.point_count(), 0);
    for (const std::uint32_t point : changed_) {
      if (!surface_.has_point(point)) continue;
      zone_.active[point] = 1;
      surface_.visit_edges(point, [&](std::uint32_t edge) { zone_.active[surface_.to(edge)] = 1; });
    }
  }

  LiveSurface& surface_;
  RefineZone& zone_;
  const RefineLimits& limits_;
  RefineCounts counts_;
  std::vector<RefineEdge> long_, short_;
  std::vector<std::uint32_t> around_;
  std::vector<std::uint32_t> changed_; ///< points
};

} // namespace

std::size_t unfit_edges(const LiveSurface& surface, const RefineZone& zone,
                        const RefineLimits& limits) {
  std::size_t count = 0;
  visit_zone(surface, zone, [&](double length, std::uint32_t from, std::uint32_t to) {
    const bool is_long = length > limits.longest && surface.point_count() < limits.max_points;
    const bool is_short = length < limits.shortest && !is_fixed(zone, from, to);
    count += is_long || is_short ? 1u : 0u;
  });
  return count;
}

RefineCounts refine(LiveSurface& surface, RefineZone& zone, const RefineLimits& limits) {
  return RefineRound(surface, zone, limits).run();
}

} // namespace nendo::deform
