#pragma once
// What a run reports to its user.

#include <string>
#include <utility>

#include <nendo/base/result.hpp>

namespace nendo::session {

/// A sentence for the user. Plain text converts to one, and an error to one that is an error.
struct Report {
  std::string text; ///< empty: nothing to say
  bool is_error = false;

  Report(std::string words, bool error = false) : text(std::move(words)), is_error(error) {}
  Report(const char* words) : text(words) {}
  Report(const Error& error) : text(error.message), is_error(true) {}
};

} // namespace nendo::session
