#include "explorer/explorer.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstring>
#include <memory>
#include <utility>

#include "explorer/fibre.hpp"

namespace nendo::explorer {
namespace {

using Order = std::memory_order;

bool writes(const Operation& operation) {
  return operation.kind != Operation::Kind::load;
}

/// Whether all that can come of `first`, then `second` of another thread, can also come of them the
/// other way round.
bool may_swap(const Operation& first, const Operation& second) {
  return first.location != second.location || !writes(first) ||
         second.kind == Operation::Kind::store;
}

/// The choices of the executions, depth first.
class Choices {
public:
  std::size_t choose(std::size_t count) {
    if (count <= 1) return 0;
    if (depth_ == taken_.size()) taken_.push_back({0, count});
    assert(taken_[depth_].count == count); // else the program chose by something of its own
    return taken_[depth_++].index;
  }
  /// To the next execution. False: there is none.
  bool advance() {
    depth_ = 0;
    while (!taken_.empty() && taken_.back().index + 1 == taken_.back().count)
      taken_.pop_back();
    if (taken_.empty()) return false;
    ++taken_.back().index;
    return true;
  }

private:
  struct Choice {
    std::size_t index;
    std::size_t count;
  };
  std::vector<Choice> taken_;
  std::size_t depth_ = 0;
};

class Explorer {
public:
  explicit Explorer(const Options& options) : options_(options) {}
  Verdict run(const std::function<Program()>& make);

  Value perform(Operation operation, const Site& site);
  void perform_fence(const Site& site);
  void perform_access(std::size_t plain, Access access);
  void require(bool holds, const char* law) {
    if (!holds && fault_.empty()) fault_ = law;
  }
  std::size_t make_location(Value initial) { return memory_.new_location(initial); }
  std::size_t make_plain() { return memory_.new_plain(running_); }

private:
  struct Thread {
    Fibre fibre;
    Operation next; ///< what it will do when it is resumed
    std::vector<std::pair<Operation, Site>> late_stores;
    std::vector<std::pair<std::size_t, Access>> late_accesses;
  };
  struct Event {
    std::size_t thread;
    Site site;
    Operation operation;
    Value read;
  };

  void execute(const std::function<Program()>& make);
  void schedule(std::size_t threads);
  void resume(std::size_t thread);
  Value step(const Operation& operation, const Site& site);
  void catch_up();
  Order order_at(const Site& site);
  bool faulty() const { return !fault_.empty() || !memory_.fault().empty(); }
  std::string trace() const;

  const Options options_;
  Choices choices_;
  std::array<Thread, max_threads> threads_;
  Verdict verdict_;

  // Of the execution that runs.
  Memory memory_;
  std::size_t running_ = 0;
  bool free_running_ =
      false; ///< to their ends, with no choice: this execution tells nothing any more
  std::string fault_;
  std::vector<Event> events_;
};

Explorer* explorer = nullptr; // the one that runs: fibres have no other way to it

Verdict Explorer::run(const std::function<Program()>& make) {
  do {
    execute(make);
    if (!free_running_) ++verdict_.executions;
    if (free_running_ && !faulty()) ++verdict_.cut;
  } while (!faulty() && choices_.advance());
  if (faulty()) {
    verdict_.fault = fault_.empty() ? memory_.fault() : fault_;
    verdict_.trace = trace();
  }
  return std::move(verdict_);
}

void Explorer::execute(const std::function<Program()>& make) {
  memory_ = Memory();
  free_running_ = false;
  events_.clear();
  const Program program = make();
  const std::size_t threads = program.threads.size();
  assert(threads < max_threads);
  memory_.spawn(threads);
  for (std::size_t n = 1; n <= threads; ++n) {
    threads_[n].fibre.start([this, n, &program] {
      program.threads[n - 1]();
      catch_up();
    });
    resume(n); // up to its first operation
  }
  schedule(threads);
  free_running_ = free_running_ || faulty();
  for (std::size_t n = 1; n <= threads; ++n) {
    while (!threads_[n].fibre.done())
      resume(n);
  }
  memory_.join_all();
  if (!free_running_ && program.at_end) program.at_end();
}

/// Runs the threads in one order. `sleeping` are those whose next operation need not come next,
/// because the executions in which it does were run before.
void Explorer::schedule(std::size_t threads) {
  std::vector<std::size_t> sleeping;
  const auto asleep = [&](std::size_t n) {
    return std::find(sleeping.begin(), sleeping.end(), n) != sleeping.end();
  };
  while (!faulty()) {
    std::vector<std::size_t> ready;
    bool done = true;
    for (std::size_t n = 1; n <= threads; ++n) {
      if (threads_[n].fibre.done()) continue;
      done = false;
      if (!asleep(n)) ready.push_back(n);
    }
    if (done) return;
    if (ready.empty()) {
      free_running_ = true;
      return;
    }
    // Stores first: then loads need not be tried before them.
    std::stable_partition(ready.begin(), ready.end(),
                          [&](std::size_t n) { return writes(threads_[n].next); });
    const std::size_t chosen = choices_.choose(ready.size());
    const Operation operation = threads_[ready[chosen]].next;
    if (options_.reduced) {
      sleeping.insert(sleeping.end(), ready.begin(),
                      ready.begin() + static_cast<std::ptrdiff_t>(chosen));
      std::erase_if(sleeping,
                    [&](std::size_t n) { return !may_swap(operation, threads_[n].next); });
    }
    resume(ready[chosen]);
  }
}

void Explorer::resume(std::size_t thread) {
  running_ = thread;
  threads_[thread].fibre.resume();
  running_ = 0;
}

/// An operation of the running thread, once it is that thread's turn.
Value Explorer::step(const Operation& operation, const Site& site) {
  if (running_ != 0 && !free_running_) {
    threads_[running_].next = operation;
    threads_[running_].fibre.suspend();
  }
  const Choose choose = [this](std::size_t count) {
    return free_running_ ? 0 : choices_.choose(count);
  };
  const Value read = memory_.apply(running_, operation, choose);
  events_.push_back({running_, site, operation, read});
  return read;
}

Value Explorer::perform(Operation operation, const Site& site) {
  operation.order = order_at(site);
  const bool late = options_.mutation.kind == Mutation::Kind::late_store &&
                    options_.mutation.site == site && running_ != 0;
  if (late) {
    threads_[running_].late_stores.emplace_back(operation, site);
    return 0;
  }
  const Value read = step(operation, site);
  const bool publishes = site.order == Order::release || site.order == Order::acq_rel;
  if (publishes) catch_up();
  return read;
}

void Explorer::perform_fence(const Site& site) {
  memory_.fence(running_, order_at(site));
}

void Explorer::perform_access(std::size_t plain, Access access) {
  verdict_.accesses += running_ != 0 ? 1U : 0U;
  const auto late =
      access == Access::read ? Mutation::Kind::late_reads : Mutation::Kind::late_writes;
  if (options_.mutation.kind == late && running_ != 0) {
    threads_[running_].late_accesses.emplace_back(plain, access);
  } else {
    memory_.access(running_, plain, access);
  }
}

/// What the mutation held up.
void Explorer::catch_up() {
  const std::size_t self = running_;
  for (const auto& [operation, site] : std::exchange(threads_[self].late_stores, {}))
    step(operation, site);
  for (const auto& [plain, access] : std::exchange(threads_[self].late_accesses, {}))
    memory_.access(self, plain, access);
}

Order Explorer::order_at(const Site& site) {
  const auto known = std::find(verdict_.sites.begin(), verdict_.sites.end(), site);
  if (known == verdict_.sites.end()) verdict_.sites.push_back(site);
  const bool weaker =
      options_.mutation.kind == Mutation::Kind::weaker && options_.mutation.site == site;
  return weaker ? options_.mutation.order : site.order;
}

std::string Explorer::trace() const {
  constexpr std::array kinds{"load", "store", "exchange", "add"};
  std::string text;
  for (const Event& event : events_) {
    const bool wrote = writes(event.operation);
    const bool read = event.operation.kind != Operation::Kind::store;
    text += "thread " + std::to_string(event.thread) + ", location " +
            std::to_string(event.operation.location) + ": " +
            kinds[static_cast<std::size_t>(event.operation.kind)];
    if (wrote) text += " " + std::to_string(event.operation.value);
    if (read) text += " read " + std::to_string(event.read);
    text += ", " + describe(event.site) + "\n";
  }
  return text;
}

} // namespace

bool Site::operator==(const Site& other) const {
  return line == other.line && kind == other.kind && order == other.order &&
         std::strcmp(file, other.file) == 0;
}

Verdict explore(const std::function<Program()>& make, const Options& options) {
  assert(explorer == nullptr);
  Explorer here(options);
  explorer = &here;
  Verdict verdict = here.run(make);
  explorer = nullptr;
  return verdict;
}

void require(bool holds, const char* law) {
  explorer->require(holds, law);
}
Value perform(const Operation& operation, const Site& site) {
  return explorer->perform(operation, site);
}
void perform_fence(const Site& site) {
  explorer->perform_fence(site);
}
std::size_t make_location(Value initial) {
  return explorer->make_location(initial);
}
std::size_t make_plain() {
  return explorer->make_plain();
}
void perform_access(std::size_t plain, Access access) {
  explorer->perform_access(plain, access);
}

const char* name_of(Order order) {
  switch (order) {
  case Order::relaxed:
    return "relaxed";
  case Order::acquire:
    return "acquire";
  case Order::release:
    return "release";
  case Order::acq_rel:
    return "acq_rel";
  default:
    return "not modelled";
  }
}

std::string describe(const Site& site) {
  constexpr std::array kinds{"load", "store", "exchange", "fence"};
  const char* slash = std::strrchr(site.file, '/');
  const std::string function(site.function,
                             std::strcspn(site.function, "<")); // no template arguments
  return std::string(slash == nullptr ? site.file : slash + 1) + ":" + std::to_string(site.line) +
         " " + function + "(), " + kinds[static_cast<std::size_t>(site.kind)] + " " +
         name_of(site.order);
}

} // namespace nendo::explorer
