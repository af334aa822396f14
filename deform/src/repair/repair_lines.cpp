// What repairing did, in words.

#include <cstdio>

#include <nendo/deform/repair.hpp>

namespace nendo::deform {
namespace {

std::string line_of(const LeftOut& left) {
  std::string line =
      "left out " + std::to_string(left.faces) + (left.faces == 1 ? " face" : " faces");
  if (left.parts > 1) line += " in " + std::to_string(left.parts) + " parts, the first";
  return line + " at " + left.where + ": it " + left.why + "; " + left.remedy + " if it is wanted";
}

} // namespace

std::vector<std::string> lines_of(const Repair& repair) {
  std::vector<std::string> lines;
  const auto add = [&](std::size_t count, const char* did, const char* one, const char* many,
                       const std::string& more) {
    if (count == 0) return;
    lines.push_back(std::string(did) + " " + std::to_string(count) + " " +
                    (count == 1 ? one : many) + more);
  };
  char tolerance[64];
  std::snprintf(tolerance, sizeof tolerance, "%.3g", repair.tolerance);
  add(repair.joined, "joined", "vertex", "vertices",
      std::string(" with others no farther away than ") + tolerance);
  add(repair.dropped, "dropped", "face", "faces",
      " that had fewer than three corners or repeated another");
  add(repair.repeated, "dropped", "corner", "corners", " that repeated the one before in its face");
  add(repair.split, "split an edge at", "vertex", "vertices", " that lay in it");
  add(repair.turned, "turned", "face", "faces", " round");
  add(repair.separated, "separated surfaces that only touched, by", "more vertex", "more vertices",
      "");
  add(repair.filled, "filled", "hole", "holes",
      repair.filled_crossing == 0
          ? ""
          : "; " + std::to_string(repair.filled_crossing) +
                (repair.filled_crossing == 1 ? " lid goes" : " lids go") + " through the model");
  add(repair.stray, "dropped", "vertex", "vertices", " without a face");
  for (const LeftOut& left : repair.left_out)
    lines.push_back(line_of(left));
  if (repair.skipped_junctions)
    lines.emplace_back("has too many open edges to look for vertices that lie in them, so where "
                       "such vertices are it may have got thin slits or lids; join its vertices "
                       "with a greater --tolerance, or close it where it was made");
  return lines;
}

} // namespace nendo::deform
