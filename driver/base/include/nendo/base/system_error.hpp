#pragma once
// The error of a failed system call.

#include <cerrno>
#include <string>
#include <system_error>

#include <nendo/base/result.hpp>

namespace nendo {

/// Returns the error of the last system call for that place: "PLACE: WHAT: why; REMEDY". Its kind
/// is no_permission or failed.
inline Error system_error(const std::string& place, const std::string& what,
                          const std::string& remedy) {
  const int number = errno;
  const bool is_forbidden = number == EACCES || number == EPERM;
  return {is_forbidden ? Errc::no_permission : Errc::failed,
          place + ": " + what + ": " + std::generic_category().message(number) + "; " + remedy};
}

} // namespace nendo
