#include "explorer/scenarios.hpp"

#include <array>
#include <memory>

#include <nendo/base/job_offer.hpp>
#include <nendo/base/seq_lock.hpp>
#include <nendo/base/shared_slots.hpp>
#include <nendo/base/spsc_ring.hpp>
#include <nendo/base/triple_buffer.hpp>

#include "explorer/atomics.hpp"

namespace nendo::explorer {
namespace {

using Numbers = std::vector<Value>;

/// What the two sides share, and what each of them notes for itself.
struct Spsc {
  SpscRing<Value, Explored> ring{2};
  Numbers accepted; ///< the producer's
  Numbers taken;    ///< the consumer's

  void push(Value number) {
    if (ring.try_push(number)) accepted.push_back(number);
  }
  void pop() {
    Value number = 0;
    if (ring.try_pop(number)) taken.push_back(number);
  }
  void drain() {
    ring.drain([this](Value number) { taken.push_back(number); });
  }
  void check(Value offered) {
    const std::size_t held = ring.size();
    const RingCounters counters = ring.counters();
    require(counters.offered == offered, "every push is counted");
    require(counters.offered == counters.consumed + counters.refused + held,
            "offered = consumed + refused + held");
    require(counters.consumed == taken.size(), "every pop is counted");
    require(counters.high_water >= held && counters.high_water <= 2, "the high water is a fill");
    drain();
    require(taken == accepted, "what was accepted comes out, once, whole and in order");
  }
};

Program spsc_program(const std::shared_ptr<Spsc>& shared, Value offered,
                     const std::function<void(Spsc&)>& producer,
                     const std::function<void(Spsc&)>& consumer) {
  return {{[=] { producer(*shared); }, [=] { consumer(*shared); }},
          [=] { shared->check(offered); }};
}

struct Pair {
  Value number = 0;
  Value complement = 0;
};

struct Latest {
  TripleBuffer<Value, Explored> value{0};
  Value overwritten = 0; ///< the writer's
  Value seen = 0;        ///< the reader's
  Value last = 0;

  void publish(Value number) {
    value.back() = number;
    overwritten += value.publish() ? 1U : 0U;
  }
  void update() {
    const bool fresh = value.update();
    const Value now = value.front();
    require(fresh ? now > last : now == last, "values go forward, and change by an update alone");
    last = now;
    seen += fresh ? 1U : 0U;
  }
};

/// Two slots of two words each, as a segment has them for its readers.
struct Staged {
  struct Slot {
    SeqLock<Explored> stage;
    std::array<Explored::Atomic<Value>, 2> words;
  };
  std::array<Slot, 2> slots;
  Explored::Atomic<Value> newest;

  void write(Value number) {
    Slot& slot = slots[number % 2];
    slot.stage.open(number);
    slot.words[0].store(number, std::memory_order_relaxed);
    slot.words[1].store(~number, std::memory_order_relaxed);
    slot.stage.close(number);
    newest.store(number, std::memory_order_relaxed);
  }
  bool read(Value number) {
    Slot& slot = slots[number % 2];
    if (!slot.stage.holds(number)) return false;
    const Value word = slot.words[0].load(std::memory_order_relaxed);
    const Value complement = slot.words[1].load(std::memory_order_relaxed);
    if (!slot.stage.still_holds(number)) return false;
    require(word == number && complement == ~number, "what is read is whole, and that content");
    return true;
  }
  void look() {
    const Value number = newest.load(std::memory_order_relaxed);
    if (number > 0) read(number);
  }
};

/// Jobs are numbers; done is what their number makes of `result`.
struct Jobs {
  JobOffer<Value, Explored> offer;
  Explored::Plain<Value> result{0};
  Numbers withdrawn, seen_done; ///< the offering thread's
  Numbers done;                 ///< the other's
  bool waits = false; ///< the offering thread gave up before it had seen the last one done

  /// False: the job was taken, and is not done yet.
  bool give(Value number) {
    offer.offer(number);
    if (offer.withdraw()) {
      withdrawn.push_back(number);
      return true;
    }
    waits = !offer.is_done();
    if (waits) return false;
    require(result == number, "what was done is seen");
    seen_done.push_back(number);
    return true;
  }
  void look() {
    Value number = 0;
    if (!offer.take(number)) return;
    result = number;
    done.push_back(number);
    offer.done();
  }
  void check() {
    Value number = 0;
    require(!offer.take(number), "no job is left");
    if (waits) {
      require(offer.is_done(), "a job that could not be withdrawn was done");
      seen_done.push_back(result);
    }
    require(seen_done == done, "each job was withdrawn or done, and that once");
  }
};

/// A loop changes a shape at each tick until it is asked to hold still. Who asked then makes a
/// model of the shape and hands that over.
struct HandOver {
  JobOffer<Value, Explored> offer;
  Explored::Plain<Value> shape{0};
  Explored::Plain<Value> model{0};
  Value ticks = 0; ///< that changed the shape
  Value taken = 0; ///< the model that the loop has
  bool is_still = false;
  bool is_late = false; ///< the maker gave up waiting, or has not handed anything over

  static constexpr Value hold_still = 1;
  static constexpr Value change_model = 2;

  void tick() {
    Value job = 0;
    const bool any = offer.take(job);
    if (any && job == change_model) {
      require(is_still, "a model comes to a loop that holds still");
      require(model == shape, "it is made of all that was shaped");
      taken = model;
      is_still = false;
    }
    if (!is_still) shape = ++ticks;
    if (any && job == hold_still) is_still = true;
    if (any) offer.done();
  }
  void make() {
    offer.offer(hold_still);
    is_late = !offer.is_done() && !offer.is_done();
    if (is_late) return;
    model = shape;
    offer.offer(change_model);
  }
  void check() {
    tick();
    require(is_late || taken > 0, "a model that was handed over is taken");
  }
};

/// A writer replaces a value, and destroys those that no reader uses: it sets them to 0.
struct Replaced {
  SharedSlots<Value, 2, Explored> slots;
  Value last = 0;     ///< the writer's
  Value replaced = 0; ///< how often there was a free slot

  void replace(Value number) {
    const std::size_t other = 1 - slots.newest();
    if (!slots.is_free(other)) return;
    slots.at(other) = 0;
    slots.at(other) = number;
    slots.publish(other);
    last = number;
    ++replaced;
  }
  void read(Value& previous) {
    const std::size_t slot = slots.acquire();
    const Value value = slots[slot];
    require(value >= previous, "values never go back");
    require(value == 0 || value > 10, "no reader sees a value that was destroyed");
    slots.release(slot);
    previous = value;
  }
};

} // namespace

std::vector<Scenario> spsc_ring_scenarios() {
  const auto ring = [] { return std::make_shared<Spsc>(); };
  return {
      {"one at a time, five into two slots",
       [=] {
         return spsc_program(
             ring(), 5,
             [](Spsc& shared) {
               for (Value number = 1; number <= 5; ++number)
                 shared.push(number);
             },
             [](Spsc& shared) {
               for (int n = 0; n < 4; ++n)
                 shared.pop();
             });
       }},
      {"pushed together, drained",
       [=] {
         return spsc_program(
             ring(), 5,
             [](Spsc& shared) {
               for (const auto& batch : {std::array<Value, 2>{1, 2}, std::array<Value, 2>{3, 4}}) {
                 const std::size_t fitting = shared.ring.push_n(batch);
                 shared.accepted.insert(shared.accepted.end(), batch.begin(),
                                        batch.begin() + static_cast<std::ptrdiff_t>(fitting));
               }
               shared.push(5);
             },
             [](Spsc& shared) {
               shared.drain();
               shared.pop();
               shared.drain();
             });
       }},
      {"filled in place, and counted by an onlooker",
       [=] {
         const auto shared = ring();
         Program program = spsc_program(
             shared, 3,
             [](Spsc& self) {
               const std::size_t granted = self.ring.claim(3); // of which one can not fit
               for (std::size_t n = 0; n < granted; ++n) {
                 self.ring.claimed(n) = n + 1;
                 self.accepted.push_back(n + 1);
               }
               self.ring.commit(granted);
               self.ring.refuse(3 - granted);
             },
             [](Spsc& self) {
               self.drain();
               const RingCounters seen = self.ring.counters();
               require(seen.high_water >= self.taken.size(), "so many were in it at once");
             });
         program.threads.emplace_back(
             [shared] { require(shared->ring.size() <= 2, "no more come out than went in"); });
         return program;
       }},
  };
}

std::vector<Scenario> triple_buffer_scenarios() {
  return {{"four values, four looks", [] {
             const auto shared = std::make_shared<Latest>();
             return Program{{[=] {
                               for (Value number = 1; number <= 4; ++number)
                                 shared->publish(number);
                             },
                             [=] {
                               for (int n = 0; n < 4; ++n)
                                 shared->update();
                             }},
                            [=] {
                              shared->update();
                              require(shared->last == 4, "the newest comes at last");
                              require(shared->seen + shared->overwritten == 4,
                                      "seen + overwritten = published");
                            }};
           }}};
}

std::vector<Scenario> seq_lock_scenarios() {
  return {{"four contents in two slots, three looks at the newest", [] {
             const auto shared = std::make_shared<Staged>();
             return Program{{[=] {
                               for (Value number = 1; number <= 4; ++number)
                                 shared->write(number);
                             },
                             [=] {
                               for (int n = 0; n < 3; ++n)
                                 shared->look();
                             }},
                            [=] {
                              for (Value number = 1; number <= 5; ++number)
                                require(shared->read(number) == (number == 3 || number == 4),
                                        "at rest the newest are there, and only those");
                            }};
           }}};
}

std::vector<Scenario> job_offer_scenarios() {
  return {{"three jobs, three looks",
           [] {
             const auto shared = std::make_shared<Jobs>();
             return Program{{[=] {
                               for (Value number = 1; number <= 3 && shared->give(number);)
                                 ++number;
                             },
                             [=] {
                               for (int n = 0; n < 3; ++n)
                                 shared->look();
                             }},
                            [=] { shared->check(); }};
           }},
          {"a loop holds still until it gets the model that is made of its shape", [] {
             const auto shared = std::make_shared<HandOver>();
             return Program{{[=] { shared->make(); },
                             [=] {
                               for (int n = 0; n < 3; ++n)
                                 shared->tick();
                             }},
                            [=] { shared->check(); }};
           }}};
}

std::vector<Scenario> shared_slots_scenarios() {
  return {{"three values in two slots, two readers", [] {
             const auto shared = std::make_shared<Replaced>();
             const auto reader = [=](int reads) {
               return [=] {
                 Value previous = 0;
                 for (int n = 0; n < reads; ++n)
                   shared->read(previous);
               };
             };
             return Program{{[=] {
                               for (Value number = 11; number <= 13; ++number)
                                 shared->replace(number);
                             },
                             reader(2), reader(1)},
                            [=] {
                              require(shared->replaced > 0, "an unused slot is free");
                              require(shared->slots.is_free(1 - shared->slots.newest()),
                                      "at rest the other slot is free");
                              Value previous = 0;
                              shared->read(previous);
                              require(previous == shared->last, "at rest the newest is there");
                            }};
           }}};
}

} // namespace nendo::explorer
