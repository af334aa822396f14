#include "nendo/injective_deform.hpp"

#include <algorithm>
#include <sstream>

#include <nendo/deform/injective_chain.hpp>

namespace nendo::app {
namespace {

using namespace nendo::deform;

/// Ordinary strokes need ten; thousands mean displacements of thousands of radii.
constexpr int most_links = 2000;

std::string report_of(const InjectiveChain& chain, double least_determinant) {
  const ChainReport& report = chain.report();
  std::ostringstream text;
  text.precision(3);
  text << report.links << (report.links == 1 ? " link" : " links") << ", bound " << report.bound;
  if (report.links > 1) text << " (" << report.whole_bound << " in one step)";
  text << ", least determinant " << least_determinant << ", " << report.held_pairs
       << (report.held_pairs == 1 ? " pair held apart" : " pairs held apart");
  const char* before = ": ";
  for (const HeldPair& wall : chain.walls()) {
    if (wall.push <= 0.0) continue;
    text << before << wall.first + 1 << '-' << wall.second + 1;
    before = ", ";
  }
  return text.str();
}

} // namespace

Result<InjectiveDeformation> deform_injectively(Points& vertices, const ControlVectors& vectors,
                                                const Supports& supports, const CsrbfOptions& csrbf,
                                                const std::string& name) {
  InjectiveChain chain(vectors.starts.cols(), supports, csrbf, {.most_links = most_links});
  FieldStatus status = chain.grab(vectors.starts);
  if (is_solved(status)) {
    const FieldStatus asked = chain.from_start(vectors.starts + vectors.displacements);
    status = std::max(status, asked);
  }
  DeterminantProbe probe;
  probe.start(vertices);
  while (is_solved(status) && chain.next()) {
    probe.advance(chain.field());
    displace(chain.field(), vertices, vertices);
  }
  status = std::max(status, chain.report().status);
  if (!is_solved(status))
    return Error{Errc::bad_input, name + ": " + std::string(describe(status))};
  if (!chain.report().reached)
    return Error{Errc::bad_input, name + ": --injective needs more than " +
                                      std::to_string(most_links) +
                                      " links; make the displacements shorter"};
  const double least = std::min(probe.least(), chain.report().least_determinant);
  return InjectiveDeformation{status, report_of(chain, least)};
}

} // namespace nendo::app
