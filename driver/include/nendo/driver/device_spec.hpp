#pragma once
// The specification of a glove or a tracker, with one grammar everywhere, and for drivers, in this
// library and in programs, the parsers of its options: numbers and words from a short list.

#include <initializer_list>
#include <map>
#include <string>
#include <string_view>

#include <nendo/base/result.hpp>

namespace nendo::driver {

/// `kind:target?key=value&key=value`, split but not validated.
struct DeviceSpec {
  std::string text; ///< as typed
  std::string kind;
  std::string target; ///< may be empty
  std::map<std::string, std::string> options;
};

/// Error: usage, naming the malformed part.
NENDO_API Result<DeviceSpec> parse_device_spec(std::string_view text);
/// Returns the text of a specification with one more option, such as "station=1".
NENDO_API std::string with_option(std::string_view spec, std::string_view option);

/// Fails with the error `usage` if `spec` has an option that is not `known`. The message names the
/// option and all known ones.
NENDO_API Result<void> allow_options(const DeviceSpec& spec,
                                     std::initializer_list<std::string_view> known);

/// Returns the option's number, or the first of `known` if the option is missing. Error: usage,
/// naming all of `known`.
NENDO_API Result<int> number_option(const DeviceSpec& spec, std::string_view key,
                                    std::initializer_list<int> known);

/// Returns the option's word, or the first of `known` if the option is missing. Error: usage,
/// naming all of `known`. `known` must contain literals.
NENDO_API Result<std::string_view> word_option(const DeviceSpec& spec, std::string_view key,
                                               std::initializer_list<std::string_view> known);

/// Fails with the error `usage` if `spec` names no port. `example` is a specification that names
/// one.
NENDO_API Result<void> require_port(const DeviceSpec& spec, std::string_view example);

} // namespace nendo::driver
