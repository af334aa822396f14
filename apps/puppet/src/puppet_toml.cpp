// Reading puppet files.

#include <algorithm>
#include <cmath>
#include <utility>

#include <nendo/base/text.hpp>
#include <nendo/base/units.hpp>
#include <nendo/puppet/puppet.hpp>

#include "config/toml_reader.hpp"

namespace nendo::puppet {

using config::TomlReader;
using Eigen::Vector3d;

namespace {

constexpr double largest = 1e9;           // of lengths, model units
constexpr double largest_value = 1e3;     // of functions, and of a point's part in a turn
constexpr std::size_t max_entries = 1000; // of [[parts]], and of [[masks]]
constexpr std::string_view left = "Left";

Vector3d vector_of(const std::array<double, 3>& numbers) {
  return {numbers[0], numbers[1], numbers[2]};
}

class PuppetReader {
public:
  PuppetReader(TomlReader& reader, Puppet& puppet) : reader_(reader), puppet_(puppet) {}

  void read(const toml::table& root) {
    reader_.allow_only(root, {"version", "model", "distance", "mirror", "mirror_at", "clutch",
                              "points", "functions", "parts", "masks", "inverted"});
    const bool is_played = root.contains("points") || root.contains("functions");
    if (is_played || root.contains("model")) puppet_.model = reader_.text(root, "model");
    const std::string distance = root.get("distance") ? reader_.text(root, "distance") : "surface";
    puppet_.distance = distance == "air" ? Distance::euclidean : Distance::surface;
    if (distance != "air" && distance != "surface")
      reader_.complain(root, "distance must be \"surface\" or \"air\"");
    puppet_.mirrors = root.get("mirror") != nullptr;
    if (puppet_.mirrors && reader_.text(root, "mirror") != "x")
      reader_.complain(root, "mirror must be \"x\": the plane x = 0; or leave it out");
    puppet_.inverted = root.contains("inverted") && reader_.truth(root, "inverted");
    if (root.get("clutch") != nullptr) read_clutch(root);
    if (is_played)
      read_played(root);
    else
      read_mask_file(root);
    if (root.get("parts") != nullptr) read_list(root, "parts", [&](const auto& one) { part(one); });
    if (root.get("masks") != nullptr) read_list(root, "masks", [&](const auto& one) { mask(one); });
    if (is_played) check(root);
  }

private:
  void read_played(const toml::table& root) {
    if (root.contains("mirror_at"))
      reader_.complain(root, "mirror_at is for masks without points; a puppet mirrors at x = 0");
    read_points(root);
    if (puppet_.mirrors) mirror_points();
    read_functions(root);
    if (puppet_.mirrors) mirror_functions();
  }
  /// Which no hand plays.
  void read_mask_file(const toml::table& root) {
    puppet_.mirror_at = number_within(root, "mirror_at", 0.0, -largest, largest);
    for (const char* key : {"distance", "clutch", "parts"})
      if (root.contains(key))
        reader_.complain(root, std::string(key) + " needs [points] and functions; add them, or "
                                                  "leave it out");
  }
  template <class Read>
  void read_list(const toml::table& root, std::string_view key, const Read& read) {
    const toml::array* const list = reader_.array(root, key);
    if (list == nullptr) return;
    if (list->size() > max_entries)
      return reader_.complain(*list, "there are more than 1000 " + std::string(key));
    reader_.each_table(*list, key, read);
  }
  double length(const toml::table& table, std::string_view key) {
    const double value = reader_.number(table, key);
    if (!(value > 0.0 && value <= largest))
      reader_.complain(table, std::string(key) + " must be more than 0, and at most 1e9");
    return value;
  }
  Vector3d place(const toml::node& node, std::string_view what) {
    const Vector3d read = vector_of(reader_.numbers<3>(node, what));
    if (!(read.cwiseAbs().maxCoeff() <= largest))
      reader_.complain(node, std::string(what) + " is farther away than 1e9");
    return read;
  }
  Vector3d place(const toml::table& table, std::string_view key) {
    const toml::node* const node = reader_.find(table, key);
    return node == nullptr ? Vector3d(Vector3d::Zero()) : place(*node, key);
  }
  /// Names go into messages and captions, and into other programs' lists.
  std::string name(const toml::key& key, const toml::node& where) {
    const std::string_view text = key.str();
    constexpr std::string_view letters =
        "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-";
    if (text.empty() || text.size() > 64 ||
        text.find_first_not_of(letters) != std::string_view::npos)
      reader_.complain(where, "'" + std::string(text.substr(0, 40)) +
                                  "': a name has 1 to 64 letters, digits, _ and -");
    return std::string(text);
  }
  /// A number that may be left out.
  double number_or(const toml::table& table, std::string_view key, double usual) {
    return table.get(key) == nullptr ? usual : reader_.number(table, key);
  }

  double number_within(const toml::table& table, std::string_view key, double usual, double least,
                       double most) {
    const double value = number_or(table, key, usual);
    if (!(value >= least && value <= most))
      reader_.complain(table, std::string(key) + " must be within " + short_text(least) + " and " +
                                  short_text(most));
    return value;
  }
  static std::string short_text(double value) {
    std::string text = decimal_text(value);
    return text.ends_with(".0") ? text.substr(0, text.size() - 2) : text;
  }
  void read_clutch(const toml::table& root) {
    const toml::table* const table = reader_.table(root, "clutch");
    if (table == nullptr) return;
    reader_.allow_only(*table, {"left", "right", "held_s", "fist_deg", "pinch_m"});
    ClutchOptions& clutch = puppet_.clutch;
    for (const auto& [side, key] : {std::pair{Side::left, "left"}, std::pair{Side::right, "right"}})
      if (table->get(key) != nullptr)
        clutch.means[static_cast<std::size_t>(side)] =
            reader_.named(*table, key, clutch_trigger_named);
    clutch.held_s = number_within(*table, "held_s", clutch.held_s, 0.25, 5.0);
    clutch.fist_deg = number_within(*table, "fist_deg", clutch.fist_deg, 90.0, 250.0);
    clutch.pinch_m = number_within(*table, "pinch_m", clutch.pinch_m, 0.005, 0.04);
  }

  void read_points(const toml::table& root) {
    const toml::table* const points = reader_.table(root, "points");
    if (points == nullptr) return;
    if (points->size() > Puppet::max_points)
      return reader_.complain(*points, "there are more than 1000 points");
    for (const auto& [key, node] : *points) {
      const toml::table* const table = reader_.as_table(node, key.str());
      if (table == nullptr || reader_.error()) return;
      reader_.allow_only(*table, {"vertex", "at", "radius", "weights", "pin"});
      PuppetPoint& point = puppet_.points.emplace_back();
      point.name = name(key, node);
      read_radius(*table, point);
      point.is_pin = table->get("pin") != nullptr && reader_.truth(*table, "pin");
      if (table->get("vertex") != nullptr)
        point.vertex = static_cast<std::uint32_t>(reader_.count(*table, "vertex", 0xFFFFFFFE));
      else
        point.at = place(*table, "at");
    }
  }
  /// One radius, or a list of them with a list of weights.
  void read_radius(const toml::table& table, PuppetPoint& point) {
    const toml::node* const node = reader_.find(table, "radius");
    if (node == nullptr) return;
    if (!node->is_array()) {
      point.radius = length(table, "radius");
      if (table.get("weights") != nullptr)
        reader_.complain(table, "weights belong to several radii, and there is one");
      return;
    }
    const std::vector<double> radii = positive_numbers(table, "radius");
    const std::vector<double> weights = table.get("weights") == nullptr
                                            ? std::vector<double>(radii.size(), 1.0)
                                            : positive_numbers(table, "weights");
    if (weights.size() != radii.size())
      reader_.complain(table, "there must be as many weights as radii");
    if (reader_.error()) return;
    for (std::size_t at = 0; at < radii.size(); ++at)
      point.mix.push_back({radii[at], weights[at]});
    point.radius = std::ranges::max(radii);
  }
  std::vector<double> positive_numbers(const toml::table& table, std::string_view key) {
    const toml::array* const list = reader_.array(table, key);
    if (list == nullptr) return {};
    if (list->empty() || list->size() > PuppetPoint::max_radii)
      reader_.complain(*list, std::string(key) + " must be a list of 1 to 4 numbers");
    std::vector<double> values;
    for (const toml::node& node : *list) {
      values.push_back(reader_.number(node, key));
      if (!(values.back() >= 1e-9 && values.back() <= largest))
        reader_.complain(node, std::string(key) + " must be within 1e-9 and 1e9");
    }
    return values;
  }
  void mirror_points() {
    const std::size_t count = puppet_.points.size();
    for (std::size_t at = 0; at < count; ++at) {
      PuppetPoint twin = puppet_.points[at];
      twin.name = twin_of(twin.name);
      if (!puppet_.points[at].name.ends_with(left) || find(twin.name)) continue;
      twin.is_mirrored = true;
      puppet_.points.push_back(std::move(twin));
    }
  }
  std::optional<std::size_t> find(std::string_view name) const {
    const auto found = std::ranges::find(puppet_.points, name, &PuppetPoint::name);
    if (found == puppet_.points.end()) return std::nullopt;
    return static_cast<std::size_t>(found - puppet_.points.begin());
  }
  std::size_t point_named(const toml::node& where, std::string_view name) {
    const auto found = find(name);
    if (!found)
      reader_.complain(where, "there is no point '" + std::string(name) + "'; add it to [points]");
    return found.value_or(0);
  }

  void read_functions(const toml::table& root) {
    const toml::table* const functions = reader_.table(root, "functions");
    if (functions == nullptr) return;
    if (functions->size() > Puppet::max_functions)
      return reader_.complain(*functions, "there are more than 64 functions");
    for (const auto& [key, node] : *functions) {
      const toml::table* const table = reader_.as_table(node, key.str());
      if (table == nullptr || reader_.error()) return;
      puppet_.functions.push_back(function(*table, name(key, node)));
    }
  }
  Function function(const toml::table& table, std::string name) {
    reader_.allow_only(
        table, {"input", "travel_deg", "travel_m", "least", "most", "curve", "turn", "move"});
    Function read;
    read.name = std::move(name);
    read.input = reader_.named(table, "input", HandSignal::named);
    read.travel = read.input.is_angle() ? from_degrees(reader_.number(table, "travel_deg"))
                                        : reader_.number(table, "travel_m");
    if (!(std::abs(read.travel) >= 1e-6))
      reader_.complain(table, "the travel of " + read.name + " must not be 0");
    read.least = number_or(table, "least", 0.0);
    read.most = number_or(table, "most", 1.0);
    if (!(read.least <= 0.0 && read.most >= 0.0 && read.least < read.most))
      reader_.complain(table, read.name + ": least must be at most 0, and most at least 0");
    if (read.least < -largest_value || read.most > largest_value)
      reader_.complain(table, read.name + ": least and most must be within -1000 and 1000");
    const std::string curve = table.get("curve") ? reader_.text(table, "curve") : "linear";
    read.eases = curve == "ease";
    if (curve != "linear" && curve != "ease")
      reader_.complain(table, "curve must be \"linear\" or \"ease\"");
    if (table.get("turn") != nullptr) turn(table, read);
    if (table.get("move") != nullptr) move(table, read);
    if (read.moves.empty()) reader_.complain(table, read.name + " has neither move nor turn");
    return read;
  }
  void turn(const toml::table& function, Function& read) {
    const toml::table* const table = reader_.table(function, "turn");
    if (table == nullptr) return;
    reader_.allow_only(*table, {"degrees", "axis", "through", "points"});
    AxisTurn& turn = read.turn.emplace();
    turn.degrees = reader_.number(*table, "degrees");
    if (!(std::abs(turn.degrees) <= 360.0))
      reader_.complain(*table, "degrees must be within -360 and 360");
    turn.axis = place(*table, "axis");
    turn.through = place(*table, "through");
    if (!(turn.axis.norm() > 1e-9)) reader_.complain(*table, "the axis has no direction");
    const toml::table* const points = reader_.table(*table, "points");
    if (points == nullptr) return;
    for (const auto& [key, node] : *points) {
      const double part = reader_.number(node, key.str());
      if (!(std::abs(part) <= largest_value))
        reader_.complain(node, std::string(key.str()) + " must be within -1000 and 1000");
      read.moves.push_back({point_named(node, key.str()), Vector3d::Zero(), part});
    }
  }
  void move(const toml::table& function, Function& read) {
    const toml::table* const table = reader_.table(function, "move");
    if (table == nullptr) return;
    for (const auto& [key, node] : *table) {
      Move one;
      one.point = point_named(node, key.str());
      one.vector = place(node, key.str());
      read.moves.push_back(one);
    }
  }
  void mirror_functions() {
    const Vector3d flip(-1.0, 1.0, 1.0);
    const std::size_t count = puppet_.functions.size();
    for (std::size_t at = 0; at < count; ++at) {
      Function twin = puppet_.functions[at];
      if (!twin.name.ends_with(left)) continue;
      twin.name = twin_of(twin.name);
      if (puppet_.function_named(twin.name)) continue;
      twin.input = twin.input.mirrored();
      twin.is_twin = true;
      if (twin.turn) {
        twin.turn->through = twin.turn->through.cwiseProduct(flip);
        twin.turn->axis = -twin.turn->axis.cwiseProduct(flip); // of a mirrored turn
      }
      for (Move& move : twin.moves) {
        move.point = find(twin_of(puppet_.points[move.point].name)).value_or(move.point);
        move.vector = move.vector.cwiseProduct(flip);
      }
      puppet_.functions.push_back(std::move(twin));
    }
  }

  void part(const toml::table& table) {
    reader_.allow_only(table, {"vertices", "inside", "points", "near"});
    PuppetPart& read = puppet_.parts.emplace_back();
    if (table.get("inside") != nullptr) {
      const toml::array* const box = reader_.array(table, "inside");
      if (box == nullptr) return;
      if (box->size() != 2) return reader_.complain(table, "inside must be two corners of a box");
      read.inside = {place((*box)[0], "a corner"), place((*box)[1], "a corner")};
    }
    if (const toml::node* const range = table.get("vertices")) {
      const auto numbers = reader_.numbers<2>(*range, "vertices");
      if (!(numbers[0] >= 0.0 && numbers[1] >= numbers[0] && numbers[1] < 4294967295.0))
        return reader_.complain(table, "vertices must be the first and the last of them");
      read.first = static_cast<std::uint32_t>(numbers[0]);
      read.last = static_cast<std::uint32_t>(numbers[1]);
    }
    if (table.get("points") == nullptr && table.get("near") == nullptr) return;
    read.is_affine = table.get("points") != nullptr;
    read_part_points(table, read.is_affine ? "points" : "near", read);
    if (read.is_affine && read.points.size() < 4)
      reader_.complain(table, "a part turns with four points or more, which are not in one plane; "
                              "near = [...] takes any number, without turning");
  }
  void read_part_points(const toml::table& table, std::string_view key, PuppetPart& read) {
    const toml::array* const points = reader_.array(table, key);
    if (points == nullptr) return;
    for (const toml::node& node : *points) {
      const auto name = node.value<std::string>();
      if (!name) return reader_.complain(node, std::string(key) + " must be names in quotes");
      read.points.push_back(point_named(node, *name));
    }
  }
  void mask(const toml::table& table) {
    reader_.allow_only(table, {"at", "radius"});
    puppet_.masks.push_back({place(table, "at"), length(table, "radius")});
  }

  void check(const toml::table& root) {
    if (reader_.error()) return;
    if (puppet_.points.empty()) reader_.complain(root, "[points] is empty; add a point");
    if (puppet_.functions.empty()) reader_.complain(root, "there are no functions; add one");
    if (puppet_.points.size() > Puppet::max_points)
      reader_.complain(root, "there are more than 1000 points");
    std::size_t radii = 0;
    for (const PuppetPoint& point : puppet_.points)
      radii += point.supports().size();
    if (radii > Puppet::max_points)
      reader_.complain(root, "the points have more than 1000 radii together");
    if (puppet_.functions.size() > Puppet::max_functions)
      reader_.complain(root, "there are more than 64 functions");
    for (const Function& function : puppet_.functions)
      for (const Move& move : function.moves)
        if (puppet_.points[move.point].is_pin)
          reader_.complain(root, function.name + " moves '" + puppet_.points[move.point].name +
                                     "', which is a pin");
  }

  TomlReader& reader_;
  Puppet& puppet_;
};

} // namespace

Result<Puppet> parse_puppet(std::string_view text, std::string_view name) {
  Puppet puppet;
  const auto error =
      config::read_toml(text, name, [&](TomlReader& reader, const toml::table& root) {
        PuppetReader(reader, puppet).read(root);
      });
  if (error) return *error;
  puppet.text = text;
  return puppet;
}

} // namespace nendo::puppet
