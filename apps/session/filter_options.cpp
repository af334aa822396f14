#include "session/filter_options.hpp"

#include <spdlog/fmt/fmt.h>

namespace nendo::session {
namespace {

// Wider than any use: below, a hand would be minutes late, and above, nothing is smoothed.
constexpr double least_cutoff_hz = 0.01;
constexpr double most_cutoff_hz = 1000.0;
constexpr double most_beta = 1000.0;

} // namespace

Result<hand::FilterOptions> FilterArguments::parse() const {
  hand::FilterOptions options;
  const auto known = hand::filter_named(kind);
  if (!known) return Error{Errc::usage, "--filter " + kind + ": unknown; use off or one-euro"};
  options.kind = *known;
  if (options.kind == hand::FilterKind::off && (min_cutoff_hz || beta)) {
    return Error{Errc::usage, std::string(min_cutoff_hz ? "--filter-min-cutoff" : "--filter-beta") +
                                  ": there is no filter; add --filter one-euro"};
  }
  options.min_cutoff_hz = min_cutoff_hz.value_or(options.min_cutoff_hz);
  options.beta_hz_per_rad_s = beta.value_or(options.beta_hz_per_rad_s);
  // Written so that NaN is refused.
  if (!(options.min_cutoff_hz >= least_cutoff_hz && options.min_cutoff_hz <= most_cutoff_hz))
    return Error{Errc::usage, "--filter-min-cutoff: use 0.01 to 1000 Hz"};
  if (!(options.beta_hz_per_rad_s >= 0.0 && options.beta_hz_per_rad_s <= most_beta))
    return Error{Errc::usage, "--filter-beta: use 0 to 1000 Hz for each rad/s"};
  return options;
}

void add_filter_options(cli::Command& command, FilterArguments& arguments) {
  const hand::FilterOptions usual;
  command.add_option("--filter", arguments.kind,
                     "off, or one-euro: smooths the joints' angles, at rest more than in motion; "
                     "the summary says how late that makes them");
  command.add_option(
      "--filter-min-cutoff", arguments.min_cutoff_hz,
      fmt::format("The filter's cutoff for a joint at rest, Hz; lower is calmer, and later. "
                  "Without it, {:g}",
                  usual.min_cutoff_hz));
  command.add_option(
      "--filter-beta", arguments.beta,
      fmt::format("Hz by which the cutoff rises with each rad/s of a joint's speed; higher is less "
                  "late in motion. Without it, {:g}",
                  usual.beta_hz_per_rad_s));
}

} // namespace nendo::session
