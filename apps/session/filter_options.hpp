#pragma once
// The options --filter, --filter-min-cutoff and --filter-beta.

#include <optional>
#include <string>

#include <nendo/base/result.hpp>
#include <nendo/hand/joint_filter.hpp>

#include "cli/command.hpp"

namespace nendo::session {

struct FilterArguments {
  std::string kind = "off";
  std::optional<double> min_cutoff_hz; ///< nullopt: hand::FilterOptions' own
  std::optional<double> beta;          ///< Hz a rad/s; nullopt: hand::FilterOptions' own

  /// Parses the options. Error: usage, naming what can be used.
  Result<hand::FilterOptions> parse() const;
};

void add_filter_options(cli::Command& command, FilterArguments& arguments);

} // namespace nendo::session
