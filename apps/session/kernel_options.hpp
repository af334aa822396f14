#pragma once
// The options --kernel and --polynomial, which several commands have.

#include <string>

#include <nendo/base/result.hpp>
#include <nendo/deform/csrbf.hpp>

#include "cli/command.hpp"

namespace nendo::session {

struct KernelOptions {
  std::string kernel = "wendland-c2";
  std::string polynomial = "none";

  /// Parses the options. Error: usage, naming the known names.
  Result<deform::CsrbfOptions> parse() const;
};

void add_kernel_options(cli::Command& command, KernelOptions& options);

} // namespace nendo::session
