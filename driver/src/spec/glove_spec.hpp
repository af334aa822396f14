#pragma once
// A check that every driver's open function makes of its specification.

#include <initializer_list>
#include <string_view>

#include <nendo/base/result.hpp>
#include <nendo/driver/open_glove.hpp>

namespace nendo::driver {

/// Fails with the error `usage` if `spec` has an option that is not `known`. The message names the
/// option and those that are known.
Result<void> allow_options(const GloveSpec& spec, std::initializer_list<std::string_view> known);

} // namespace nendo::driver
