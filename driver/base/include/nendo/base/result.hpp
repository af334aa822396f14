#pragma once
// Result<T> holds a value or an Error; it is a subset of C++23's std::expected. Functions that can
// fail outside the loop return it. Inside the loop, failures are enums and counters, never strings.

#include <cassert>
#include <string>
#include <utility>
#include <variant>

#include <nendo/base/api.hpp>

namespace nendo {

/// The kinds of errors that a caller can distinguish. The values are the program's exit codes.
enum class Errc {
  failed = 1,        ///< the job failed
  usage = 2,         ///< an argument is wrong
  no_device = 3,     ///< no such glove, or it does not answer like one
  no_permission = 4, ///< the device may not be opened
  bad_input = 5,     ///< a file cannot be used
};

/// `message` is one line: what failed, where, and the remedy.
struct Error {
  Errc code = Errc::failed;
  std::string message;
};

template <class T>
class [[nodiscard]] Result {
public:
  // These are implicit on purpose, so that functions can say `return value;` and `return
  // Error{...};`.
  Result(T value) : state_(std::in_place_index<0>, std::move(value)) {}
  Result(Error error) : state_(std::in_place_index<1>, std::move(error)) {}

  explicit operator bool() const noexcept { return state_.index() == 0; }

  T& operator*() & noexcept {
    assert(*this);
    return *std::get_if<0>(&state_);
  }
  const T& operator*() const& noexcept {
    assert(*this);
    return *std::get_if<0>(&state_);
  }
  T&& operator*() && noexcept {
    assert(*this);
    return std::move(*std::get_if<0>(&state_));
  }
  T* operator->() noexcept { return &**this; }
  const T* operator->() const noexcept { return &**this; }

  const Error& error() const noexcept {
    assert(!*this);
    return *std::get_if<1>(&state_);
  }

private:
  std::variant<T, Error> state_;
};

template <>
class [[nodiscard]] Result<void> {
public:
  Result() = default;
  Result(Error error) : error_(std::move(error)), ok_(false) {}

  explicit operator bool() const noexcept { return ok_; }
  const Error& error() const noexcept {
    assert(!ok_);
    return error_;
  }

private:
  Error error_;
  bool ok_ = true;
};

} // namespace nendo
