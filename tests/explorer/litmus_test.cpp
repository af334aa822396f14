// What the explorer finds is what the memory model allows: no outcome less, none more.

#include "explorer/litmus.hpp"

#include <memory>
#include <random>

#include <doctest/doctest.h>

#include "explorer/atomics.hpp"

using namespace nendo::explorer;

namespace {

using Order = std::memory_order;
constexpr Order rlx = Order::relaxed;
constexpr Order acq = Order::acquire;
constexpr Order rel = Order::release;
constexpr std::size_t x = 0;
constexpr std::size_t y = 1;
constexpr std::size_t z = 2;

Instruction load(std::size_t location, Order order) {
  return {Instruction::Kind::load, location, 0, order};
}
Instruction store(std::size_t location, Value value, Order order) {
  return {Instruction::Kind::store, location, value, order};
}
Instruction add(std::size_t location, Value value, Order order) {
  return {Instruction::Kind::add, location, value, order};
}
Instruction fence(Order order) {
  return {Instruction::Kind::fence, 0, 0, order};
}

/// The outcomes that the explorer finds, which must be those of the axioms.
std::set<Outcome> outcomes(const Litmus& litmus) {
  const Outcomes found = explored(litmus);
  const Outcomes allowed = by_axioms(litmus);
  CHECK(found.all == allowed.all);
  CHECK(found.executions >= found.all.size());
  return found.all;
}

/// Message passing: x is the data, y says that it is there.
std::set<Outcome> message_passing(Order write, Order read) {
  return outcomes({{store(x, 1, rlx), store(y, 1, write)}, {load(y, read), load(x, rlx)}});
}

Litmus random_litmus(std::mt19937& random) {
  const auto below = [&](std::uint32_t count) {
    return static_cast<std::uint32_t>(random() % count);
  };
  const auto any_order = [&](std::initializer_list<Order> orders) {
    return orders.begin()[below(static_cast<std::uint32_t>(orders.size()))];
  };
  Litmus litmus(std::size_t{2} + below(2));
  Value fresh = 1;
  for (auto& thread : litmus) {
    const std::uint32_t length = litmus.size() == 2 ? 2 + below(3) : 1 + below(3);
    for (std::uint32_t n = 0; n < length; ++n) {
      const std::size_t location = below(2);
      switch (below(7)) {
      case 0:
      case 1:
      case 2:
        thread.push_back(load(location, any_order({rlx, acq})));
        break;
      case 3:
      case 4:
        thread.push_back(store(location, fresh++, any_order({rlx, rel})));
        break;
      case 5:
        thread.push_back(add(location, 16, any_order({rlx, acq, rel, Order::acq_rel})));
        break;
      default:
        thread.push_back(fence(any_order({acq, rel, Order::acq_rel})));
      }
    }
  }
  return litmus;
}

} // namespace

TEST_SUITE("litmus") {
  TEST_CASE("message passing: only release and acquire together bring the data along") {
    const Outcome stale{1, 0, 1, 1}; // y was seen, x was not
    CHECK(message_passing(rel, acq).size() == 3);
    CHECK_FALSE(message_passing(rel, acq).contains(stale));
    for (const auto& [write, read] : {std::pair{rlx, acq}, {rel, rlx}, {rlx, rlx}}) {
      CHECK(message_passing(write, read).size() == 4);
      CHECK(message_passing(write, read).contains(stale));
    }
  }

  TEST_CASE("message passing by fences") {
    const auto passing = [](bool first, bool second) {
      Litmus litmus{{store(x, 1, rlx)}, {load(y, rlx)}};
      if (first) litmus[0].push_back(fence(rel));
      litmus[0].push_back(store(y, 1, rlx));
      if (second) litmus[1].push_back(fence(acq));
      litmus[1].push_back(load(x, rlx));
      return outcomes(litmus).size();
    };
    CHECK(passing(true, true) == 3);
    CHECK(passing(true, false) == 4);
    CHECK(passing(false, true) == 4);
  }

  TEST_CASE("store buffering is allowed, and release and acquire do not forbid it") {
    for (const auto& [write, read] : {std::pair{rlx, rlx}, {rel, acq}}) {
      const auto found =
          outcomes({{store(x, 1, write), load(y, read)}, {store(y, 1, write), load(x, read)}});
      CHECK(found.size() == 4);
      CHECK(found.contains({0, 0, 1, 1}));
    }
  }

  TEST_CASE("load buffering is not found: loads read from stores that came before") {
    const auto found =
        outcomes({{load(x, rlx), store(y, 1, rlx)}, {load(y, rlx), store(x, 1, rlx)}});
    CHECK(found.size() == 3);
    CHECK_FALSE(found.contains({1, 1, 1, 1}));
  }

  TEST_CASE("independent reads of independent writes may disagree about their order") {
    const auto found = outcomes({{store(x, 1, rel)},
                                 {store(y, 1, rel)},
                                 {load(x, acq), load(y, acq)},
                                 {load(y, acq), load(x, acq)}});
    CHECK(found.size() == 16);
    CHECK(found.contains({1, 0, 1, 0, 1, 1}));
  }

  TEST_CASE("coherence: a thread never reads backwards, and all agree on one location's order") {
    CHECK(outcomes({{store(x, 1, rlx), store(x, 2, rlx)}, {load(x, rlx), load(x, rlx)}}).size() ==
          6);
    const auto found = outcomes({{store(x, 1, rlx)},
                                 {store(x, 2, rlx)},
                                 {load(x, rlx), load(x, rlx)},
                                 {load(x, rlx), load(x, rlx)}});
    for (const Value last : {1U, 2U})
      CHECK_FALSE(found.contains({1, 2, 2, 1, last}));
    CHECK(found.contains({1, 2, 0, 2, 2}));
  }

  TEST_CASE("two stores each in opposite orders may both end with the first") {
    const auto found =
        outcomes({{store(x, 1, rel), store(y, 2, rel)}, {store(y, 1, rel), store(x, 2, rel)}});
    CHECK(found.size() == 4);
    CHECK(found.contains({1, 1}));
  }

  TEST_CASE("happening before is transitive through a third thread") {
    const Litmus handed_on{{store(x, 1, rlx), store(y, 1, rel)},
                           {load(y, acq), store(z, 1, rel)},
                           {load(z, acq), load(x, rlx)}};
    CHECK_FALSE(outcomes(handed_on).contains({1, 1, 0, 1, 1, 1}));
    CHECK(outcomes(handed_on).size() == 7);
    Litmus broken = handed_on;
    broken[1][1].order = rlx;
    CHECK(outcomes(broken).contains({1, 1, 0, 1, 1, 1}));
  }

  TEST_CASE("a read-modify-write is atomic") {
    const auto found = outcomes({{add(x, 1, rlx)}, {add(x, 1, rlx)}});
    CHECK(found == std::set<Outcome>{{0, 1, 2}, {1, 0, 2}});
  }

  TEST_CASE("a release sequence goes on through a read-modify-write and ends at a store") {
    const auto through = [](Instruction between) {
      return outcomes(
          {{store(x, 1, rlx), store(y, 1, rel)}, {between}, {load(y, acq), load(x, rlx)}});
    };
    for (const Outcome& outcome : through(add(y, 1, rlx))) {
      if (outcome[0] == 1 && outcome[1] == 2) CHECK(outcome[2] == 1);
    }
    const auto own = outcomes(
        {{store(x, 1, rlx), store(y, 1, rel), store(y, 2, rlx)}, {load(y, acq), load(x, rlx)}});
    CHECK_FALSE(own.contains({1, 0, 1, 2}));
    CHECK(own.contains({2, 0, 1, 2})); // since C++20
  }

  TEST_CASE("random programs have the outcomes of the axioms, with and without the reduction") {
    std::mt19937 random(7);
    std::uint64_t reduced = 0;
    std::uint64_t whole = 0;
    std::size_t found = 0;
    for (int n = 0; n < 200; ++n) {
      const Litmus litmus = random_litmus(random);
      CAPTURE(n);
      const Outcomes all = explored(litmus, false);
      const Outcomes few = explored(litmus);
      REQUIRE(all.all == by_axioms(litmus).all);
      REQUIRE(few.all == all.all);
      reduced += few.executions;
      whole += all.executions;
      found += all.all.size();
    }
    CHECK(found > 1000);
    CHECK(reduced < whole / 10);
    MESSAGE("200 programs, ", found, " outcomes, ", reduced, " executions, ", whole, " unreduced");
  }

  TEST_CASE("plain accesses that nothing puts in order are a data race, whichever comes first") {
    const auto verdict = [](Order write, Order read, bool ask) {
      return explore([=] {
        struct State {
          Explored::Plain<int> data;
          Explored::Atomic<unsigned> there;
        };
        const auto state = std::make_shared<State>();
        Program program;
        program.threads.emplace_back([=] {
          state->data = 1;
          state->there.store(1, write);
        });
        program.threads.emplace_back([=] {
          if (state->there.load(read) == 1 || !ask) require(state->data == 1, "the data is there");
        });
        return program;
      });
    };
    CHECK(verdict(rel, acq, true).fault.empty());
    for (const auto& wrong :
         {verdict(rlx, acq, true), verdict(rel, rlx, true), verdict(rel, acq, false)})
      CHECK(wrong.fault.find("data race") != std::string::npos);
    CHECK(verdict(rel, rlx, true).trace.find("read 1") != std::string::npos);
  }

  TEST_CASE("seq_cst is refused: it would be taken for less than it is") {
    const Litmus litmus{{store(x, 1, Order::seq_cst)}};
    CHECK(explored(litmus).executions == 0);
  }
}
