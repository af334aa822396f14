#pragma once
// The options --kernel and --polynomial, which several commands have.

#include <string>

#include <CLI/CLI.hpp>

#include <nendo/base/result.hpp>
#include <nendo/deform/csrbf.hpp>

namespace nendo::app {

struct KernelOptions {
  std::string kernel = "wendland-c2";
  std::string polynomial = "none";

  /// Error: usage, naming what is known.
  Result<deform::CsrbfOptions> parse() const {
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
};

inline void add_kernel_options(CLI::App& command, KernelOptions& options) {
  command
      .add_option("--kernel", options.kernel,
                  "wendland-c0, wendland-c2, wendland-c4 or wendland-c6")
      ->capture_default_str();
  command
      .add_option("--polynomial", options.polynomial,
                  "none, constant or linear; anything but none moves the whole model")
      ->capture_default_str();
}

} // namespace nendo::app
