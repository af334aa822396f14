#include "explorer/litmus.hpp"

#include <algorithm>
#include <deque>
#include <memory>

#include "explorer/atomics.hpp"

namespace nendo::explorer {
namespace {

using Word = Explored::Atomic<Value>;

struct State {
  std::deque<Word> locations;
  std::vector<Outcome> read;
};

std::size_t locations_of(const Litmus& litmus) {
  std::size_t count = 0;
  for (const auto& thread : litmus) {
    for (const Instruction& instruction : thread)
      count = std::max(count, instruction.location + 1);
  }
  return count;
}

void run(State& state, const std::vector<Instruction>& thread, std::size_t self) {
  for (const auto& [kind, location, value, order] : thread) {
    Word& word = state.locations[location];
    switch (kind) {
    case Instruction::Kind::load:
      state.read[self].push_back(word.load(order));
      break;
    case Instruction::Kind::store:
      word.store(value, order);
      break;
    case Instruction::Kind::add:
      state.read[self].push_back(word.fetch_add(value, order));
      break;
    case Instruction::Kind::fence:
      Explored::fence(order);
      break;
    }
  }
}

} // namespace

Outcomes explored(const Litmus& litmus, bool reduced) {
  Outcomes outcomes;
  const auto make = [&] {
    const auto state = std::make_shared<State>();
    for (std::size_t n = 0; n < locations_of(litmus); ++n)
      state->locations.emplace_back();
    state->read.resize(litmus.size());
    Program program;
    for (std::size_t n = 0; n < litmus.size(); ++n)
      program.threads.emplace_back([state, &litmus, n] { run(*state, litmus[n], n); });
    program.at_end = [state, &outcomes] {
      Outcome outcome;
      for (const Outcome& read : state->read)
        outcome.insert(outcome.end(), read.begin(), read.end());
      for (const Word& word : state->locations)
        outcome.push_back(word.load(std::memory_order_relaxed));
      outcomes.all.insert(outcome);
    };
    return program;
  };
  const Verdict verdict = explore(make, {{}, reduced});
  outcomes.executions = verdict.fault.empty() ? verdict.executions : 0;
  return outcomes;
}

} // namespace nendo::explorer
