#pragma once
// Settings by name and value in text.

#include <string_view>

#include <nendo/base/result.hpp>
#include <nendo/flow/loop_settings.hpp>

namespace nendo::c {

/// Changes the setting of this name. Error: usage (no such setting, or not its value), which lists
/// what there is.
Result<void> change(flow::LoopSettings& settings, std::string_view name, std::string_view value);

} // namespace nendo::c
