// Writing puppet files.

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>

#include <nendo/base/units.hpp>
#include <nendo/puppet/puppet.hpp>

namespace nendo::puppet {

using Eigen::Vector3d;

namespace {

/// The shortest text that is read as the same number.
std::string toml_number(double value) {
  std::array<char, 40> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value + 0.0).ptr;
  std::string written(text.data(), end);
  constexpr double largest_count = 1e9; // TOML's whole numbers have an end
  if (std::abs(value) > largest_count && written.find_first_of(".e") == std::string::npos)
    written += ".0";
  return written;
}

/// The shortest number of degrees that is read as these radians.
std::string toml_degrees(double rad) {
  constexpr int max_digits = std::numeric_limits<double>::max_digits10;
  const double degrees = to_degrees(rad);
  for (int digits = 1; digits <= max_digits; ++digits) {
    std::array<char, 40> text{};
    const auto end = std::to_chars(text.data(), text.data() + text.size(), degrees,
                                   std::chars_format::general, digits)
                         .ptr;
    double read = 0.0;
    std::from_chars(text.data(), end, read);
    if (from_degrees(read) == rad) return toml_number(read);
  }
  for (const double other : {std::nextafter(degrees, 1e300), std::nextafter(degrees, -1e300)})
    if (from_degrees(other) == rad) return toml_number(other);
  return toml_number(degrees);
}

std::string toml_text(std::string_view words) {
  constexpr std::string_view digits = "0123456789abcdef";
  std::string text = "\"";
  for (const char letter : words) {
    const auto code = static_cast<unsigned char>(letter);
    if (letter == '"' || letter == '\\') {
      text += '\\';
      text += letter;
    } else if (code < 0x20 || code == 0x7F) {
      text += "\\u00";
      text += digits[code / 16];
      text += digits[code % 16];
    } else {
      text += letter;
    }
  }
  return text + '"';
}

std::string toml_vector(const Vector3d& vector) {
  return "[" + toml_number(vector.x()) + ", " + toml_number(vector.y()) + ", " +
         toml_number(vector.z()) + "]";
}

/// "{ a = 1, b = 2 }", of the entries.
std::string toml_table(const std::vector<std::string>& entries) {
  std::string text;
  for (const std::string& entry : entries)
    text += (text.empty() ? "{ " : ", ") + entry;
  return text.empty() ? "{}" : text + " }";
}

std::string toml_names(const Puppet& puppet, const std::vector<std::size_t>& points) {
  std::string text;
  for (const std::size_t point : points)
    text += (text.empty() ? "" : ", ") + toml_text(puppet.points[point].name);
  return "[" + text + "]";
}

/// The lines at the beginning that are comments or empty.
std::string_view comments_before(std::string_view text) {
  std::size_t end = 0;
  while (end < text.size() && (text[end] == '#' || text[end] == '\n')) {
    const std::size_t line = text.find('\n', end);
    if (line == std::string_view::npos) return {};
    end = line + 1;
  }
  return text.substr(0, end);
}

void add_radii(const PuppetPoint& point, std::vector<std::string>& entries) {
  if (point.mix.empty()) return entries.push_back("radius = " + toml_number(point.radius));
  std::string radii, weights;
  bool are_alike = true;
  for (const deform::Support& support : point.mix) {
    radii += (radii.empty() ? "" : ", ") + toml_number(support.radius);
    weights += (weights.empty() ? "" : ", ") + toml_number(support.weight);
    are_alike = are_alike && support.weight == 1.0;
  }
  entries.push_back("radius = [" + radii + "]");
  if (!are_alike) entries.push_back("weights = [" + weights + "]");
}

std::string point_line(const PuppetPoint& point) {
  std::vector<std::string> entries;
  entries.push_back(point.vertex ? "vertex = " + std::to_string(*point.vertex)
                                 : "at = " + toml_vector(point.at));
  add_radii(point, entries);
  if (point.is_pin) entries.emplace_back("pin = true");
  return point.name + " = " + toml_table(entries) + "\n";
}

std::string function_lines(const Puppet& puppet, const Function& function) {
  std::string text = "\n[functions." + function.name + "]\n";
  text += "input = " + toml_text(function.input.name()) + "\n";
  text += function.input.is_angle() ? "travel_deg = " + toml_degrees(function.travel) + "\n"
                                    : "travel_m = " + toml_number(function.travel) + "\n";
  if (function.least != 0.0) text += "least = " + toml_number(function.least) + "\n";
  if (function.most != 1.0) text += "most = " + toml_number(function.most) + "\n";
  if (function.eases) text += "curve = \"ease\"\n";
  std::vector<std::string> turned, moved;
  for (const Move& move : function.moves) {
    const std::string name = puppet.points[move.point].name + " = ";
    if (move.part)
      turned.push_back(name + toml_number(*move.part));
    else
      moved.push_back(name + toml_vector(move.vector));
  }
  if (function.turn)
    text += "turn = " +
            toml_table({"degrees = " + toml_number(function.turn->degrees),
                        "axis = " + toml_vector(function.turn->axis),
                        "through = " + toml_vector(function.turn->through),
                        "points = " + toml_table(turned)}) +
            "\n";
  if (!moved.empty() || !function.turn) text += "move = " + toml_table(moved) + "\n";
  return text;
}

std::string part_lines(const Puppet& puppet, const PuppetPart& part) {
  const std::uint32_t no_end = PuppetPart{}.last;
  std::string text = "\n[[parts]]\n";
  if (part.inside)
    text += "inside = [" + toml_vector(part.inside->lowest) + ", " +
            toml_vector(part.inside->highest) + "]\n";
  if (part.first != 0 || part.last != no_end)
    text += "vertices = [" + std::to_string(part.first) + ", " +
            std::to_string(std::min(part.last, no_end - 1)) + "]\n";
  if (!part.points.empty() || !part.is_affine)
    text += (part.is_affine ? "points = " : "near = ") + toml_names(puppet, part.points) + "\n";
  return text;
}

std::string clutch_lines(const ClutchOptions& clutch) {
  const ClutchOptions usual;
  if (clutch == usual) return {};
  std::string text = "\n[clutch]\n";
  for (const Side side : {Side::left, Side::right})
    text += std::string(name_of(side)) + " = " +
            toml_text(std::string(name_of(clutch.means[static_cast<std::size_t>(side)]))) + "\n";
  if (clutch.held_s != usual.held_s) text += "held_s = " + toml_number(clutch.held_s) + "\n";
  if (clutch.fist_deg != usual.fist_deg)
    text += "fist_deg = " + toml_number(clutch.fist_deg) + "\n";
  if (clutch.pinch_m != usual.pinch_m) text += "pinch_m = " + toml_number(clutch.pinch_m) + "\n";
  return text;
}

/// What only a puppet has that hands play.
std::string played_lines(const Puppet& puppet) {
  std::string text = "\n[points]\n";
  for (const PuppetPoint& point : puppet.points)
    if (!point.is_mirrored) text += point_line(point);
  for (const Function& function : puppet.functions)
    if (!function.is_twin) text += function_lines(puppet, function);
  for (const PuppetPart& part : puppet.parts)
    text += part_lines(puppet, part);
  return text;
}

} // namespace

std::string text_of(const Puppet& puppet) {
  const bool is_played = puppet.is_played();
  std::string text(comments_before(puppet.text));
  text += "version = 1\n";
  if (is_played || !puppet.model.empty()) text += "model = " + toml_text(puppet.model) + "\n";
  if (is_played)
    text += puppet.distance == Distance::euclidean ? "distance = \"air\"\n"
                                                   : "distance = \"surface\"\n";
  if (puppet.mirrors) text += "mirror = \"x\"\n";
  if (puppet.mirrors && puppet.mirror_at != 0.0)
    text += "mirror_at = " + toml_number(puppet.mirror_at) + "\n";
  if (puppet.inverted) text += "inverted = true\n";
  text += clutch_lines(puppet.clutch);
  if (is_played) text += played_lines(puppet);
  for (const Mask& mask : puppet.masks)
    text += "\n[[masks]]\nat = " + toml_vector(mask.at) + "\nradius = " + toml_number(mask.radius) +
            "\n";
  return text;
}

void count_from(const Vector3d& offset, Puppet& puppet) {
  if (offset.isZero(0.0)) return;
  for (PuppetPoint& point : puppet.points)
    if (!point.vertex) point.at -= offset;
  const auto twin_place = [](const Vector3d& at) { return Vector3d(-at.x(), at.y(), at.z()); };
  for (Function& function : puppet.functions) {
    if (!function.turn) continue;
    Vector3d& through = function.turn->through;
    through =
        function.is_twin ? twin_place(twin_place(through) - offset) : Vector3d(through - offset);
  }
  for (PuppetPart& part : puppet.parts)
    if (part.inside)
      part.inside = deform::Box{part.inside->lowest - offset, part.inside->highest - offset};
  for (Mask& mask : puppet.masks)
    mask.at -= offset;
  if (puppet.mirror_at != 0.0) puppet.mirror_at -= offset.x();
  puppet.text = text_of(puppet);
}

} // namespace nendo::puppet
