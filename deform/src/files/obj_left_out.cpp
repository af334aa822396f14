#include "files/obj_left_out.hpp"

#include <algorithm>

#include <nendo/base/text.hpp>

namespace nendo::deform {

namespace {

/// Statements of the format (Wavefront's Appendix B1) that leave polygons as they are: normals,
/// smoothing, display and the parts of curves, which curv and surf stand for.
constexpr std::string_view harmless[] = {
    "vn",     "vp",     "s",   "mg",   "lod",  "bevel",  "c_interp",   "d_interp",
    "usemap", "maplib", "deg", "bmat", "step", "cstype", "parm",       "trim",
    "hole",   "scrv",   "sp",  "end",  "con",  "ctech",  "stech",      "call",
    "csh",    "bzp",    "bsp", "cdc",  "cdp",  "res",    "shadow_obj", "trace_obj",
};

std::string several(std::size_t count, const char* one, const char* more) {
  return std::to_string(count) + " " + (count == 1 ? one : more);
}

} // namespace

void ObjLeftOut::statement(std::string_view keyword, std::size_t line) {
  if (keyword == "l")
    ++lines_;
  else if (keyword == "p")
    ++points_;
  else if (keyword == "curv" || keyword == "curv2" || keyword == "surf")
    ++curves_;
  else if (std::find(std::begin(harmless), std::end(harmless), keyword) == std::end(harmless)) {
    if (unknown_++ > 0) return;
    first_unknown_ = in_quotes(keyword);
    first_unknown_line_ = line;
  }
}

void ObjLeftOut::add_to(std::vector<std::string>& notes) const {
  std::string what;
  const auto add = [&](std::size_t count, const char* one, const char* more) {
    if (count > 0) what += (what.empty() ? "" : ", ") + several(count, one, more);
  };
  add(lines_, "line of edges (l)", "lines of edges (l)");
  add(points_, "line of points (p)", "lines of points (p)");
  add(curves_, "curve or curved surface (curv, surf)", "curves and curved surfaces (curv, surf)");
  const bool is_one = lines_ + points_ + curves_ == 1;
  if (!what.empty())
    notes.push_back(what + (is_one ? " is" : " are") + " left out; only faces (f) are read");
  if (weights_ > 0)
    notes.push_back("the fourth number of " + several(weights_, "vertex", "vertices") +
                    " is left out, because w weights curves and not polygons");
  if (unknown_ > 0)
    notes.push_back(several(unknown_, "line", "lines") + " of an unknown kind " +
                    (unknown_ == 1 ? "is" : "are") + " left out (" +
                    (unknown_ == 1 ? "" : "first ") + first_unknown_ + " in line " +
                    std::to_string(first_unknown_line_) + ")");
}

} // namespace nendo::deform
