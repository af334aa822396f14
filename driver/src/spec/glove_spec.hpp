#pragma once
// What every driver's open function needs to judge its specification.

#include <initializer_list>
#include <string_view>

#include <nendo/base/result.hpp>
#include <nendo/driver/open_glove.hpp>

namespace nendo::driver {

/// Error: usage, if `spec` has an option that is not `known`; it names both.
Result<void> allow_options(const GloveSpec& spec, std::initializer_list<std::string_view> known);

} // namespace nendo::driver
