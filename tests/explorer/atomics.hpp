#pragma once
// Explored: the policy (see nendo/base/atomics.hpp) under which explore() runs the lock-free
// classes.

#include <atomic>
#include <type_traits>

#include "explorer/explorer.hpp"

namespace nendo::explorer {

struct Explored {
  template <class T>
  class Atomic {
    static_assert(std::is_unsigned_v<T>);
    using Order = std::memory_order;

  public:
    static constexpr bool is_always_lock_free = std::atomic<T>::is_always_lock_free;

    Atomic(T initial = 0) : location_(make_location(initial)) {} // NOLINT: converts, as std::atomic
    Atomic(const Atomic&) = delete;
    Atomic& operator=(const Atomic&) = delete;

    T load(Order order, int line = __builtin_LINE(), const char* file = __builtin_FILE(),
           const char* function = __builtin_FUNCTION()) const {
      return act(Operation::Kind::load, 0, {Site::Kind::load, order, file, function, line});
    }
    void store(T value, Order order, int line = __builtin_LINE(),
               const char* file = __builtin_FILE(), const char* function = __builtin_FUNCTION()) {
      act(Operation::Kind::store, value, {Site::Kind::store, order, file, function, line});
    }
    T exchange(T value, Order order, int line = __builtin_LINE(),
               const char* file = __builtin_FILE(), const char* function = __builtin_FUNCTION()) {
      return act(Operation::Kind::exchange, value,
                 {Site::Kind::update, order, file, function, line});
    }
    T fetch_add(T value, Order order, int line = __builtin_LINE(),
                const char* file = __builtin_FILE(), const char* function = __builtin_FUNCTION()) {
      return act(Operation::Kind::add, value, {Site::Kind::update, order, file, function, line});
    }

  private:
    T act(Operation::Kind kind, T value, const Site& site) const {
      return static_cast<T>(perform({kind, location_, value, site.order}, site));
    }

    std::size_t location_;
  };

  /// A plain object whose accesses are checked for data races.
  template <class T>
  class Plain {
  public:
    Plain() : plain_(make_plain()) {}
    Plain(const T& value) : plain_(make_plain()), value_(value) {} // NOLINT: converts, as a T does
    Plain(const Plain& other) : plain_(make_plain()), value_(other) {}
    Plain& operator=(const Plain& other) { return *this = static_cast<const T&>(other); }
    Plain& operator=(const T& value) {
      perform_access(plain_, Access::write);
      value_ = value;
      return *this;
    }
    operator const T&() const { // NOLINT: converts, as a T does
      perform_access(plain_, Access::read);
      return value_;
    }

  private:
    std::size_t plain_;
    T value_{};
  };

  static void fence(std::memory_order order, int line = __builtin_LINE(),
                    const char* file = __builtin_FILE(),
                    const char* function = __builtin_FUNCTION()) {
    perform_fence({Site::Kind::fence, order, file, function, line});
  }
};

} // namespace nendo::explorer
