#pragma once
// The sheet to print: the bracelets of both wrists, before they are cut out.

#include <string>

namespace nendo::markers {

/// Returns an A4 page as SVG: both bracelets with lines to cut and to fold at, a ruler of 100 mm to
/// check the print with, and what to do. The markers are where corners_on_sheet() says.
std::string draw_sheet();

} // namespace nendo::markers
