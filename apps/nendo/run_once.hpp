#pragma once
// One run, from its arguments to its report.

#include <functional>

#include <Eigen/Core>

#include <nendo/base/result.hpp>

#include "nendo/run_arguments.hpp"
#include "session/observer.hpp"

namespace nendo::app::run_command {

/// Up to this size, a tick of 64 links takes less than the period of 90 Hz.
inline constexpr Eigen::Index max_injective_unasked = 100'000;

/// Opens the window of a run whose arguments are complete.
using OpenWindow = std::function<Result<session::Observer*>(const RunArguments& options)>;

/// Runs until the end, in a window if `open_window` is not empty, and prints the report. Returns
/// the exit code. Blocks. Errors: those of check(), read_model(), the gloves and the run.
Result<int> run_once(RunArguments& options, const OpenWindow& open_window = {});

} // namespace nendo::app::run_command
