#include "edit/edit_words.hpp"

#include <charconv>
#include <cmath>
#include <cstdio>

#include <nendo/base/text.hpp>

#include "cli/output_place.hpp"
#include "timeline/timeline_file.hpp"

namespace nendo::edit {
namespace {

// Cuts a finite number off the front.
bool cut_number(std::string_view& text, double& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || !std::isfinite(value)) return false;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return true;
}

} // namespace

Result<Side> parse_hand(const std::string& text) {
  if (text == "left") return Side::left;
  if (text == "right") return Side::right;
  return Error{Errc::usage, "--hand " + text + ": use left or right"};
}

Result<hand::Finger> parse_finger(const std::string& text) {
  for (std::size_t at = 0; at < hand::finger_count; ++at)
    if (const auto finger = static_cast<hand::Finger>(at); name_of(finger) == text) return finger;
  return Error{Errc::usage, "--finger " + text + ": use thumb, index, middle, ring or little"};
}

Result<Eigen::Vector3d> parse_place(const std::string& text) {
  std::string_view rest = text;
  Eigen::Vector3d place;
  bool fine = true;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    if (axis > 0) {
      fine = fine && rest.starts_with(',');
      if (fine) rest.remove_prefix(1);
    }
    fine = fine && cut_number(rest, place[axis]);
  }
  if (fine && rest.empty()) return place;
  return Error{Errc::usage, "--to " + text + ": use X,Y,Z in the model's units"};
}

std::string fixed(double number, int decimals) {
  char digits[400]; // the largest double has 309 before the point
  std::snprintf(digits, sizeof digits, "%.*f", decimals, number);
  return digits;
}

Result<std::string> edited_file(const std::string& file, const std::string& out) {
  if (!out.empty()) {
    if (const auto fine = cli::check_place("--out", out, {timeline::file_ending}); !fine)
      return fine.error();
    return out;
  }
  if (timeline::is_timeline(file)) return file;
  return Error{Errc::usage, file + ": a timeline's name ends in .timeline.toml"};
}

Result<timeline::Tolerance> parse_tolerance(const std::string& text) {
  std::string_view rest = text;
  double value = 0.0;
  timeline::Tolerance tolerance;
  const auto length_m = to_metres(text);
  const bool fine = cut_number(rest, value) && value >= 0.0;
  if (fine && length_m) {
    tolerance.tip_m = tolerance.point_m = *length_m;
  } else if (fine && rest == "rad") {
    tolerance.angle_rad = value;
  } else if (fine && rest == "deg") {
    tolerance.angle_rad = from_degrees(value);
  } else {
    return Error{Errc::usage, "--tolerance " + text +
                                  ": use a length at the fingertips, like 1mm, or an angle at the "
                                  "joints, like 0.02rad or 1deg"};
  }
  return tolerance;
}

} // namespace nendo::edit
