#include "explorer/litmus.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstdint>
#include <optional>
#include <vector>

namespace nendo::explorer {
namespace {

using Kind = Instruction::Kind;
using Order = std::memory_order;
constexpr std::size_t max_events = 24;

/// A relation between events: bit b of row a says that a comes before b.
struct Relation {
  std::array<std::uint32_t, max_events> rows{};

  void add(std::size_t a, std::size_t b) { rows[a] |= std::uint32_t{1} << b; }
  bool has(std::size_t a, std::size_t b) const { return ((rows[a] >> b) & 1U) != 0; }
  Relation operator|(const Relation& other) const {
    Relation both = *this;
    for (std::size_t n = 0; n < max_events; ++n)
      both.rows[n] |= other.rows[n];
    return both;
  }
  Relation then(const Relation& other) const {
    Relation joined;
    for (std::size_t a = 0; a < max_events; ++a) {
      for (std::size_t b = 0; b < max_events; ++b)
        joined.rows[a] |= has(a, b) ? other.rows[b] : 0;
    }
    return joined;
  }
  Relation closure() const {
    Relation closed = *this;
    for (std::size_t via = 0; via < max_events; ++via) {
      for (std::size_t a = 0; a < max_events; ++a)
        closed.rows[a] |= closed.has(a, via) ? closed.rows[via] : 0;
    }
    return closed;
  }
  bool irreflexive() const {
    for (std::size_t n = 0; n < max_events; ++n)
      if (has(n, n)) return false;
    return true;
  }
};

/// A candidate: who reads from whom, and the modification order of each location.
class Graph {
public:
  explicit Graph(const Litmus& litmus) {
    for (const auto& thread : litmus)
      for (const Instruction& instruction : thread)
        if (instruction.kind != Kind::fence)
          locations_ = std::max(locations_, instruction.location + 1);
    for (std::size_t n = 0; n < locations_; ++n)
      events_.push_back({Kind::store, n, 0, Order::relaxed});
    for (const auto& thread : litmus) {
      const std::size_t first = events_.size();
      events_.insert(events_.end(), thread.begin(), thread.end());
      assert(events_.size() <= max_events);
      for (std::size_t b = first; b < events_.size(); ++b) {
        for (std::size_t a = 0; a < locations_; ++a)
          program_order_.add(a, b);
        for (std::size_t a = first; a < b; ++a)
          program_order_.add(a, b);
      }
    }
    source_.resize(events_.size());
    orders_.resize(locations_);
    for (std::size_t n = 0; n < events_.size(); ++n)
      if (writes(n)) orders_[events_[n].location].push_back(n);
  }

  void enumerate(Outcomes& outcomes) { choose_source(locations_, outcomes); }

private:
  bool writes(std::size_t n) const {
    return events_[n].kind == Kind::store || events_[n].kind == Kind::add;
  }
  bool reads(std::size_t n) const {
    return events_[n].kind == Kind::load || events_[n].kind == Kind::add;
  }
  bool fence(std::size_t n) const { return events_[n].kind == Kind::fence; }
  bool acquires(std::size_t n) const {
    return events_[n].order == Order::acquire || events_[n].order == Order::acq_rel;
  }
  bool releases(std::size_t n) const {
    return events_[n].order == Order::release || events_[n].order == Order::acq_rel;
  }

  void choose_source(std::size_t reader, Outcomes& outcomes) {
    if (reader == events_.size()) return choose_order(0, outcomes);
    if (!reads(reader)) return choose_source(reader + 1, outcomes);
    for (std::size_t writer = 0; writer < events_.size(); ++writer) {
      if (!writes(writer) || writer == reader) continue;
      if (events_[writer].location != events_[reader].location) continue;
      source_[reader] = writer;
      choose_source(reader + 1, outcomes);
    }
  }
  void choose_order(std::size_t location, Outcomes& outcomes) {
    if (location == locations_) {
      if (const auto outcome = judge()) {
        outcomes.all.insert(*outcome);
        ++outcomes.executions;
      }
      return;
    }
    auto& order = orders_[location];
    std::sort(order.begin(), order.end()); // the initial value is first, and stays there
    do {
      choose_order(location + 1, outcomes);
    } while (std::next_permutation(order.begin() + 1, order.end()));
  }

  std::optional<Outcome> judge() const {
    Relation reads_from;
    Relation modification;
    Relation reads_before;
    for (const auto& order : orders_)
      for (std::size_t b = 1; b < order.size(); ++b)
        for (std::size_t a = 0; a < b; ++a)
          modification.add(order[a], order[b]);
    for (std::size_t n = 0; n < events_.size(); ++n)
      if (reads(n)) reads_from.add(source_[n], n);
    if (!(program_order_ | reads_from).closure().irreflexive()) return std::nullopt;
    for (std::size_t n = 0; n < events_.size(); ++n) {
      if (!reads(n)) continue;
      // A read-modify-write is a read and then a write: it cannot read what its write comes before.
      if (writes(n) && !modification.has(source_[n], n)) return std::nullopt;
      for (std::size_t later = 0; later < events_.size(); ++later) {
        if (!modification.has(source_[n], later) || later == n) continue;
        reads_before.add(n, later);
        if (writes(n) && modification.has(later, n)) return std::nullopt; // not atomic
      }
    }
    const Relation extended = (reads_from | modification | reads_before).closure();
    const Relation happens = (program_order_ | synchronizes(reads_from)).closure();
    if (!happens.irreflexive() || !happens.then(extended).irreflexive()) return std::nullopt;
    return outcome();
  }

  /// From a release, by itself or as a fence before a store, to the acquire that reads from that
  /// store or from the read-modify-writes that follow it.
  Relation synchronizes(const Relation& reads_from) const {
    Relation update_chain; // store, then those that read from it and write, and so on
    for (std::size_t a = 0; a < events_.size(); ++a)
      for (std::size_t b = 0; b < events_.size(); ++b)
        if (reads_from.has(a, b) && writes(b)) update_chain.add(a, b);
    update_chain = update_chain.closure();
    for (std::size_t n = 0; n < events_.size(); ++n)
      update_chain.add(n, n);
    const Relation seen_by = update_chain.then(reads_from);
    Relation synchronized;
    for (std::size_t head = 0; head < events_.size(); ++head) {
      if (!writes(head)) continue;
      for (std::size_t reader = 0; reader < events_.size(); ++reader) {
        if (!seen_by.has(head, reader)) continue;
        for (std::size_t from = 0; from < events_.size(); ++from) {
          const bool before = from == head || (fence(from) && program_order_.has(from, head));
          if (!before || !releases(from)) continue;
          for (std::size_t to = 0; to < events_.size(); ++to) {
            const bool after = to == reader || (fence(to) && program_order_.has(reader, to));
            if (after && acquires(to)) synchronized.add(from, to);
          }
        }
      }
    }
    return synchronized;
  }

  Value written(std::size_t n) const {
    return events_[n].kind == Kind::add ? written(source_[n]) + events_[n].value : events_[n].value;
  }
  Outcome outcome() const {
    Outcome values;
    for (std::size_t n = 0; n < events_.size(); ++n)
      if (reads(n)) values.push_back(written(source_[n]));
    for (const auto& order : orders_)
      values.push_back(written(order.back()));
    return values;
  }

  std::size_t locations_ = 0;
  std::vector<Instruction> events_; ///< the locations' initial values first
  Relation program_order_;
  std::vector<std::size_t> source_;              ///< of each event that reads
  std::vector<std::vector<std::size_t>> orders_; ///< the writes to each location
};

} // namespace

Outcomes by_axioms(const Litmus& litmus) {
  Outcomes outcomes;
  Graph(litmus).enumerate(outcomes);
  return outcomes;
}

} // namespace nendo::explorer
