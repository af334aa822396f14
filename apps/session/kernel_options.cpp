#include "session/kernel_options.hpp"

namespace nendo::session {

Result<deform::CsrbfOptions> KernelOptions::parse() const {
  deform::CsrbfOptions options;
  const auto known_kernel = deform::wendland_named(kernel);
  if (!known_kernel) {
    return Error{Errc::usage,
                 "--kernel " + kernel +
                     ": unknown; use wendland-c0, wendland-c2, wendland-c4 or wendland-c6"};
  }
  const auto known_polynomial = deform::polynomial_named(polynomial);
  if (!known_polynomial) {
    return Error{Errc::usage,
                 "--polynomial " + polynomial + ": unknown; use none, constant or linear"};
  }
  options.kernel = *known_kernel;
  options.polynomial = *known_polynomial;
  return options;
}

void add_kernel_options(cli::Command& command, KernelOptions& options) {
  command.add_option("--kernel", options.kernel,
                     "wendland-c0, wendland-c2, wendland-c4 or wendland-c6");
  command.add_option("--polynomial", options.polynomial,
                     "none, constant or linear; anything but none moves the whole model");
}

} // namespace nendo::session
