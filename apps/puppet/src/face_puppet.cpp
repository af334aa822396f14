#include "face_puppet.hpp"

#include <cmath>

#include <nendo/base/text.hpp>

namespace nendo::puppet {

namespace {

/// Rounded to a power of ten that is fine enough for this unit.
std::string rounded_text(double value, double unit) {
  const double grain = std::pow(10.0, std::floor(std::log10(unit / 2000.0)));
  const double digits = std::round(1.0 / grain); // exact where the grain is a decimal
  const double rounded =
      grain < 1.0 ? std::round(value * digits) / digits : std::round(value / grain) * grain;
  return decimal_text(rounded + 0.0); // no -0
}

std::string turn_text(const DraftFunction& function, double unit) {
  std::string text = "turn = { degrees = " + rounded_text(function.part * function.turn_deg, 20.0) +
                     ", axis = [1, 0, 0], through = " +
                     vector_text({0.0, function.axis_y, function.axis_z}, unit) + ", points = { ";
  for (std::size_t at = 0; at < function.turns.size(); ++at)
    text += (at == 0 ? "" : ", ") + function.turns[at].first + " = " +
            decimal_text(function.turns[at].second);
  return text + " } }\n";
}

std::string move_text(const DraftFunction& function, double unit) {
  std::string text = "move = { ";
  for (std::size_t at = 0; at < function.moves.size(); ++at)
    text += (at == 0 ? "" : ", ") + function.moves[at].first + " = " +
            vector_text(function.part * function.moves[at].second, unit);
  return text + " }\n";
}

std::string function_text(const DraftFunction& function, double unit) {
  std::string text = "\n";
  if (function.part < 1.0)
    text += "# As much as the surface takes: at " +
            std::to_string(static_cast<int>(std::lround(100.0 / function.part))) +
            " % of this, triangles turn over.\n";
  text += "[functions." + function.name + "]\ninput = \"" + function.input +
          "\"\ntravel_deg = " + std::to_string(std::lround(function.travel_deg)) + "\n";
  if (function.eases) text += "curve = \"ease\"\n";
  return text + (function.turns.empty() ? move_text(function, unit) : turn_text(function, unit));
}

} // namespace

std::string vector_text(const Eigen::Vector3d& vector, double unit) {
  return "[" + rounded_text(vector.x(), unit) + ", " + rounded_text(vector.y(), unit) + ", " +
         rounded_text(vector.z(), unit) + "]";
}

std::string PuppetDraft::text() const {
  std::string text;
  for (const std::string& comment : comments)
    text += "# " + comment + "\n";
  text += "version = 1\nmodel = \"" + model +
          "\"\ndistance = \"surface\"\nmirror = \"x\"\n\n[points]\n";
  for (const DraftPoint& point : points)
    text += point.name + " = { " + point.place + ", radius = " + rounded_text(point.radius, unit) +
            (point.is_pin ? ", pin = true }\n" : " }\n");
  for (const DraftFunction& function : functions)
    text += function_text(function, unit);
  return text + parts;
}

} // namespace nendo::puppet
