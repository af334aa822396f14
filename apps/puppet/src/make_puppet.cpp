#include <nendo/puppet/make_puppet.hpp>

#include <array>
#include <charconv>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include <nendo/base/text.hpp>
#include <nendo/deform/surface_graph.hpp>
#include <nendo/puppet/rig_check.hpp>

namespace nendo::puppet {
using deform::Mesh;
using Eigen::Vector3d;

namespace {

struct DraftPoint {
  std::string name;
  std::string place; ///< `at = [...]` or `vertex = ...`
  double radius = 1.0;
  bool is_pin = false;
};

struct DraftFunction {
  std::string name;
  std::string input;
  double travel_deg = 90.0;
  bool eases = true;
  /// A turn about an axis along x through (0, y, z), of each point by its part; or moves.
  double turn_deg = 0.0;
  double axis_y = 0.0, axis_z = 0.0;
  std::vector<std::pair<std::string, double>> turns{};
  std::vector<std::pair<std::string, Eigen::Vector3d>> moves{};
  double part = 1.0; ///< fraction of the intended value, since more would fold
};

/// A puppet's file: points and functions that can still be changed.
struct PuppetDraft {
  std::string model;
  std::vector<std::string> comments; ///< lines
  std::vector<DraftPoint> points;
  std::vector<DraftFunction> functions;
  std::string parts; ///< as in the file
  double unit = 1.0; ///< the face's, by which numbers are rounded

  std::string text() const;
};

/// Rounded to a power of ten that is fine enough for this unit.
std::string rounded_text(double value, double unit) {
  const double grain = std::pow(10.0, std::floor(std::log10(unit / 2000.0)));
  const double digits = std::round(1.0 / grain); // exact where the grain is a decimal
  const double rounded =
      grain < 1.0 ? std::round(value * digits) / digits : std::round(value / grain) * grain;
  return decimal_text(rounded + 0.0); // no -0
}

/// Returns `[x, y, z]`, rounded to a 2000th of the unit or less.
std::string vector_text(const Eigen::Vector3d& vector, double unit) {
  return "[" + rounded_text(vector.x(), unit) + ", " + rounded_text(vector.y(), unit) + ", " +
         rounded_text(vector.z(), unit) + "]";
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

/// Four digits, in any locale.
std::string number_text(double value) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value + 0.0,
                                 std::chars_format::general, 4);
  return {text.data(), end.ptr};
}

std::string place_words(const Vector3d& place) {
  return number_text(place.x()) + ", " + number_text(place.y()) + ", " + number_text(place.z());
}

/// Drafts a puppet from what was found. Lengths are in units of the face; the numbers are those
/// that made expressions of the shipped face.
class FaceDrafter {
public:
  FaceDrafter(const Mesh& model, const FaceLandmarks& face) : model_(model), face_(face) {
    draft_.unit = face.unit;
  }

  PuppetDraft draft(std::string_view model_name) {
    draft_.model = model_name;
    add_points();
    if (face_.mouth)
      add_mouth_functions();
    else
      add_plain_functions();
    add_side_functions();
    add_parts();
    return std::move(draft_);
  }

private:
  void add(std::string name, const Vector3d& at, double radius, bool is_pin = false) {
    draft_.points.push_back({std::move(name), place_text(at), radius * face_.unit, is_pin});
  }
  /// A place, or the skin's vertex, where another part of the model, such as lashes, is nearer.
  std::string place_text(const Vector3d& at) const {
    const auto nearest = deform::nearest_position(model_, at);
    if (face_.is_skin[nearest.corners[0]]) return "at = " + vector_text(at, face_.unit);
    Eigen::Index best = 0;
    double least = -1.0;
    for (Eigen::Index v = 0; v < model_.vertices.cols(); ++v) {
      const double away = (model_.vertices.col(v) - at).squaredNorm();
      if (!face_.is_skin[static_cast<std::size_t>(v)] || (least >= 0.0 && away >= least)) continue;
      least = away;
      best = v;
    }
    return "vertex = " + std::to_string(best);
  }

  void add_points() {
    const bool has_mouth = face_.mouth.has_value();
    add("jaw", face_.jaw, has_mouth ? 1.16 : 0.7);
    add("jawLeft", face_.jaw_side, has_mouth ? 1.16 : 0.8);
    add("chin", face_.chin, has_mouth ? 0.87 : 0.6);
    if (has_mouth) {
      const MouthPlaces& mouth = *face_.mouth;
      add("lipLower", mouth.lower, 0.61);
      add("lipLowerLeft", lower_side(mouth), 0.61);
      add("lipUpper", mouth.upper, 0.38);
      add("cornerLeft", mouth.corner, 0.52);
    } else {
      add("noseTip", face_.nose, 0.7);
    }
    add("nose", has_mouth ? face_.under_nose : bridge(), has_mouth ? 0.43 : 0.5, true);
    add("cheekLeft", face_.cheek, has_mouth ? 0.51 : 0.75);
    add("browInnerLeft", face_.brow_inner, 0.38);
    add("browOuterLeft", face_.brow_outer, 0.49);
    if (!face_.eye) return;
    const double lid = 0.55 * (face_.eye->outer_x - face_.eye->inner_x) / face_.unit;
    for (std::size_t k = 0; k < lids.size(); ++k) {
      add("lidUpper" + std::string(lids[k]) + "Left", face_.eye->upper[k], lid);
      add("lidLower" + std::string(lids[k]) + "Left", face_.eye->lower[k], lid);
    }
  }
  Vector3d bridge() const { return {0.0, face_.brow_inner.y(), face_.brow_inner.z()}; }
  Vector3d lower_side(const MouthPlaces& mouth) const {
    const Vector3d wanted = mouth.lower + 0.4 * (mouth.corner - mouth.lower) +
                            Vector3d(0.32 * mouth.corner.x(), 0.0, 0.0);
    return deform::nearest_position(model_, wanted).in(model_.vertices);
  }

  Vector3d scaled(double x, double y, double z) const { return face_.unit * Vector3d(x, y, z); }
  DraftFunction& function(std::string name, std::string input, double travel_deg = 90.0) {
    DraftFunction& added = draft_.functions.emplace_back();
    added.name = std::move(name);
    added.input = std::move(input);
    added.travel_deg = travel_deg;
    return added;
  }
  void add_mouth_functions() {
    DraftFunction& jaw = function("jawOpen", "right.thumb_flexion", 40.0);
    jaw.turn_deg = 12.5;
    jaw.axis_y = face_.nose.y() - 0.28 * face_.unit;
    jaw.axis_z = face_.nose.z() - 1.68 * face_.unit;
    jaw.turns = {{"jaw", 1.0},           {"jawLeft", 1.0},     {"jawRight", 1.0},
                 {"chin", 1.0},          {"lipLower", 1.0},    {"lipLowerLeft", 1.0},
                 {"lipLowerRight", 1.0}, {"cornerLeft", 0.45}, {"cornerRight", 0.45}};
    function("mouthPucker", "left.thumb_flexion", 40.0).moves = {
        {"cornerLeft", scaled(-0.145, 0.0, 0.13)},    {"cornerRight", scaled(0.145, 0.0, 0.13)},
        {"lipUpper", scaled(0.0, 0.015, 0.116)},      {"lipLower", scaled(0.0, -0.015, 0.116)},
        {"lipLowerLeft", scaled(-0.072, 0.0, 0.123)}, {"lipLowerRight", scaled(0.072, 0.0, 0.123)}};
    function("mouthSmileLeft", "right.index_flexion").moves = {
        {"cornerLeft", scaled(0.109, 0.109, -0.072)},
        {"cheekLeft", scaled(0.0145, 0.065, 0.036)},
        {"lipUpper", scaled(0.0, 0.0116, -0.007)}};
    function("mouthFrownLeft", "right.middle_flexion").moves = {
        {"cornerLeft", scaled(-0.0145, -0.10, 0.0)}};
  }
  /// Of a face whose lips do not part.
  void add_plain_functions() {
    function("chinForward", "right.thumb_flexion", 40.0).moves = {
        {"jaw", scaled(0.0, -0.06, 0.12)}, {"chin", scaled(0.0, -0.04, 0.18)}};
    function("noseLong", "left.thumb_flexion", 40.0).moves = {
        {"noseTip", scaled(0.0, -0.04, 0.25)}};
    function("cheekPuffLeft", "right.index_flexion").moves = {
        {"cheekLeft", scaled(0.07, 0.0, 0.10)}};
    function("cheekSquintLeft", "right.middle_flexion").moves = {
        {"cheekLeft", scaled(0.02, 0.11, 0.04)}};
  }
  void add_side_functions() {
    function("browDownLeft", "right.ring_flexion").moves = {
        {"browInnerLeft", scaled(-0.05, -0.08, 0.029)},
        {"browOuterLeft", scaled(0.0, -0.022, 0.0)}};
    function("browUpLeft", "right.little_flexion").moves = {
        {"browInnerLeft", scaled(0.0, 0.109, 0.0145)},
        {"browOuterLeft", scaled(0.0, 0.123, 0.0145)}};
    if (!face_.eye) return;
    DraftFunction& blink = function("eyeBlinkLeft", "right.index_mcp_abduction", 12.0);
    blink.eases = false;
    for (std::size_t k = 0; k < lids.size(); ++k) {
      const double open = face_.eye->upper[k].y() - face_.eye->lower[k].y();
      blink.moves.emplace_back("lidUpper" + std::string(lids[k]) + "Left",
                               Vector3d(0.0, -0.88 * open, 0.11 * open));
      blink.moves.emplace_back("lidLower" + std::string(lids[k]) + "Left",
                               Vector3d(0.0, 0.11 * open, 0.02 * open));
    }
  }

  void add_parts() {
    const double unit = face_.unit;
    if (face_.mouth)
      add_part("The lower gums and teeth turn with the jaw, and so does the tongue.",
               {{-0.6 * unit, face_.jaw.y() - 0.2 * unit, face_.nose.z() - 2.0 * unit},
                {0.6 * unit, face_.mouth->slit.y() - 0.015 * unit, face_.mouth->upper.z()}},
               "points = [\"jaw\", \"jawLeft\", \"jawRight\", \"chin\"]\n");
    if (face_.eye && face_.eyeball_front)
      add_part("What is in front of the eyeballs, such as lashes, goes with the lids.",
               {{-unit, face_.eye->lower[1].y() - 0.1 * unit, *face_.eyeball_front + 0.015 * unit},
                {unit, face_.eye->upper[1].y() + 0.1 * unit, face_.nose.z()}},
               "");
  }
  /// Adds it if anything but skin is in that box.
  void add_part(const std::string& comment, const deform::Box& box, const std::string& points) {
    bool is_needed = false;
    for (Eigen::Index v = 0; v < model_.vertices.cols() && !is_needed; ++v) {
      const Vector3d at = model_.vertices.col(v);
      is_needed = !face_.is_skin[static_cast<std::size_t>(v)] && box.contains(at);
    }
    if (!is_needed) return;
    draft_.parts += "\n# " + comment + "\n[[parts]]\ninside = [[" + place_words(box.lowest) +
                    "], [" + place_words(box.highest) + "]]\n" + points;
  }

  static constexpr std::array<std::string_view, 3> lids{"Inner", "", "Outer"};

  const Mesh& model_;
  const FaceLandmarks& face_;
  PuppetDraft draft_;
};

std::vector<std::string> findings(const Mesh& model, const FaceLandmarks& face) {
  std::vector<std::string> lines;
  const auto vertices = static_cast<std::size_t>(model.vertices.cols());
  lines.push_back("symmetry about x = 0: " + std::to_string(vertices - face.lone_vertices) +
                  " of " + std::to_string(vertices) +
                  " vertices have a mirror image; the sides' depths differ by " +
                  number_text(100.0 * face.asymmetry) + " % of the face" +
                  (face.is_symmetric() ? "" : ", which is much: look at the right side's points"));
  lines.push_back("nose: " + place_words(face.nose) + "; chin: " + place_words(face.chin) +
                  "; jaw's lower edge: " + place_words(face.jaw));
  if (face.mouth)
    lines.push_back("mouth: it can open; lips at " + place_words(face.mouth->upper) + " and " +
                    place_words(face.mouth->lower) + ", corner at " +
                    place_words(face.mouth->corner));
  else
    lines.emplace_back(
        "mouth: no opening was found (the skin joins the lips), so there is no jawOpen, "
        "and no function of the lips");
  if (face.eye)
    lines.push_back("eyes: they are open from x = " + number_text(face.eye->inner_x) + " to " +
                    number_text(face.eye->outer_x) + ", lids at " +
                    place_words(face.eye->upper[1]) + " and " + place_words(face.eye->lower[1]));
  else
    lines.emplace_back("eyes: no opening was found, so there is no eyeBlink");
  lines.push_back("brows: " + place_words(face.brow_inner) + " and " +
                  place_words(face.brow_outer) + ", where the surface protrudes");
  lines.emplace_back("cheek and side of the jaw: by the proportions of a face");
  return lines;
}

/// Makes functions move less until no one folds alone. Error: that of RigShapes.
Result<void> restrain(PuppetDraft& draft, const Mesh& model) {
  constexpr int max_rounds = 12;
  for (int round = 0; round < max_rounds; ++round) {
    const auto puppet = parse_puppet(draft.text(), "the puppet");
    if (!puppet) return puppet.error();
    auto shapes = RigShapes::make(std::make_shared<const Rig>(*puppet, model), model);
    if (!shapes) return shapes.error();
    const RigCheck check = check_rig(**shapes, model);
    if (check.passes()) return {};
    for (const LimitCheck& limit : check.alone)
      if (RigCheck::folds(limit))
        for (DraftFunction& function : draft.functions)
          if (function.name == puppet->functions[limit.one.function].name) function.part *= 0.9;
  }
  return {};
}

} // namespace

Result<MadePuppet> make_face_puppet(const Mesh& model, std::string_view model_name) {
  const auto face = find_face(model);
  if (!face) return face.error();
  MadePuppet made;
  made.found = findings(model, *face);
  PuppetDraft draft = FaceDrafter(model, *face).draft(model_name);
  draft.comments = {
      "Made by `nendo puppet make` from the shape of the model alone. What was found:"};
  for (const std::string& line : made.found)
    draft.comments.push_back("- " + line);
  draft.comments.insert(
      draft.comments.end(),
      {"Look at it with `nendo puppet show FILE --picture OUT.png`. If a place is wrong, correct "
       "its",
       "`at`: x, y, z in the model's unit, put to the nearest place of the surface; or give "
       "`vertex`,",
       "a number from 0. A radius is how far a point reaches along the surface: two to three times",
       "the way to its neighbours makes no bumps. Then `nendo puppet check FILE`."});
  if (const auto fine = restrain(draft, model); !fine) return fine.error();
  made.text = draft.text();
  return made;
}

} // namespace nendo::puppet
