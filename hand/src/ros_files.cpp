#include <cstring>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <expat.h>
#include <yaml.h>

#include <nendo/base/text.hpp>
#include <nendo/hand/calibration_exchange.hpp>

#include "calibration_check.hpp"
#include "ros_joints.hpp"

namespace nendo::hand {
namespace {

constexpr std::string_view table_key = "cyberglove_calibration";
constexpr std::size_t max_yaml_depth = 16; // a namespace or two, and the four lists
constexpr std::string_view yaml_shape =
    "write [name, [[raw, degrees], [raw, degrees]]] for each joint";

struct YamlNode {
  enum class Kind : std::uint8_t { scalar, list, map } kind = Kind::scalar;
  std::size_t line = 0;
  std::string text;            ///< a scalar's
  std::vector<YamlNode> parts; ///< a list's; a map's keys and values by turns
};

struct FreeParser {
  void operator()(yaml_parser_t* parser) const noexcept {
    yaml_parser_delete(parser);
    delete parser;
  }
};

struct YamlEvent {
  YamlEvent() = default;
  YamlEvent(const YamlEvent&) = delete;
  YamlEvent& operator=(const YamlEvent&) = delete;
  ~YamlEvent() { yaml_event_delete(&event); }
  yaml_event_t event{};
};

/// Builds the tree of the first document from libyaml's events. An alias is refused, so that a
/// tree is never larger than its text.
class YamlTree {
public:
  YamlTree(std::string_view text, std::string_view name) : name_(name), parser_(new yaml_parser_t) {
    if (yaml_parser_initialize(parser_.get()) == 0) {
      delete parser_.release();
      return;
    }
    yaml_parser_set_input_string(parser_.get(), reinterpret_cast<const unsigned char*>(text.data()),
                                 text.size());
  }

  Result<YamlNode> read() {
    if (parser_ == nullptr) return Error{Errc::failed, std::string(name_) + ": no memory is left"};
    YamlNode top;
    open_.push_back(&top);
    for (;;) {
      YamlEvent next;
      if (yaml_parser_parse(parser_.get(), &next.event) == 0) return broken();
      const auto type = next.event.type;
      if (type == YAML_STREAM_END_EVENT || type == YAML_DOCUMENT_END_EVENT) break;
      if (auto fine = take(next.event); !fine) return fine.error();
    }
    if (top.parts.empty()) return bad_line(name_, 1, "is empty");
    return std::move(top.parts.front());
  }

private:
  Error broken() const {
    const char* problem = parser_->problem == nullptr ? "cannot be read" : parser_->problem;
    const std::size_t line = parser_->problem_mark.line + 1;
    return bad_line(name_, line, "is no YAML: " + printable(problem) + "; fix it");
  }

  Result<void> take(const yaml_event_t& event) {
    const std::size_t line = event.start_mark.line + 1;
    switch (event.type) {
    case YAML_SCALAR_EVENT: {
      const auto& scalar = event.data.scalar;
      open_.back()->parts.push_back(
          {YamlNode::Kind::scalar,
           line,
           std::string(reinterpret_cast<const char*>(scalar.value), scalar.length),
           {}});
      return {};
    }
    case YAML_SEQUENCE_START_EVENT:
      return open(YamlNode::Kind::list, line);
    case YAML_MAPPING_START_EVENT:
      return open(YamlNode::Kind::map, line);
    case YAML_SEQUENCE_END_EVENT:
    case YAML_MAPPING_END_EVENT:
      open_.pop_back();
      return {};
    case YAML_ALIAS_EVENT:
      return bad_line(name_, line, "an alias (*) is here; write its list out");
    default:
      return {};
    }
  }

  Result<void> open(YamlNode::Kind kind, std::size_t line) {
    if (open_.size() > max_yaml_depth)
      return bad_line(name_, line, "is nested too deeply; " + std::string(yaml_shape));
    open_.back()->parts.push_back({kind, line, {}, {}});
    open_.push_back(&open_.back()->parts.back()); // its list grows only after it is closed
    return {};
  }

  std::string_view name_;
  std::unique_ptr<yaml_parser_t, FreeParser> parser_;
  std::vector<YamlNode*> open_;
};

/// Finds the list of joints: the value of `cyberglove_calibration`, within any namespaces, or the
/// whole text.
const YamlNode* joints_in(const YamlNode& node) {
  if (node.kind == YamlNode::Kind::list) return &node;
  if (node.kind != YamlNode::Kind::map) return nullptr;
  for (std::size_t at = 0; at + 1 < node.parts.size(); at += 2) {
    const YamlNode& key = node.parts[at];
    const YamlNode& value = node.parts[at + 1];
    if (key.text.ends_with(table_key)) return &value;
    if (value.kind == YamlNode::Kind::map)
      if (const YamlNode* found = joints_in(value)) return found;
  }
  return nullptr;
}

std::optional<double> yaml_number(const YamlNode& node) {
  return node.kind == YamlNode::Kind::scalar ? to_finite_number(node.text) : std::nullopt;
}

Result<RosJoint> joint_of(const YamlNode& name, const YamlNode& points, std::string_view file) {
  const auto bad = [&](const YamlNode& at, const std::string& what) {
    return bad_line(file, at.line, what + "; " + std::string(yaml_shape));
  };
  if (name.kind != YamlNode::Kind::scalar) return bad(name, "a joint's name should be here");
  RosJoint joint{name.text, name.line, {}};
  const std::string who = in_quotes(joint.name) + ": ";
  if (points.kind != YamlNode::Kind::list) return bad(points, who + "its points are no list");
  for (const YamlNode& point : points.parts) {
    if (point.kind != YamlNode::Kind::list || point.parts.size() != 2)
      return bad(point, who + "a point needs two numbers");
    const auto raw = yaml_number(point.parts[0]);
    const auto angle_deg = yaml_number(point.parts[1]);
    if (!raw || !angle_deg)
      return bad(point, who + in_quotes(point.parts[raw ? 1 : 0].text) + " is no finite number");
    joint.points.push_back({*raw, *angle_deg});
  }
  return joint;
}

Result<std::vector<RosJoint>> joints_of(const YamlNode& list, std::string_view file) {
  std::vector<RosJoint> joints;
  const bool is_map = list.kind == YamlNode::Kind::map; // G_IndexMPJ: [[raw, degrees], ...]
  for (std::size_t at = 0; at < list.parts.size(); at += is_map ? 2 : 1) {
    const YamlNode& entry = list.parts[at];
    if (!is_map && (entry.kind != YamlNode::Kind::list || entry.parts.size() != 2))
      return bad_line(file, entry.line, "this is no joint; " + std::string(yaml_shape));
    auto joint = is_map ? joint_of(entry, list.parts[at + 1], file)
                        : joint_of(entry.parts[0], entry.parts[1], file);
    if (!joint) return joint.error();
    joints.push_back(*std::move(joint));
  }
  return joints;
}

constexpr std::size_t max_xml_depth = 8;

struct FreeXmlParser {
  void operator()(XML_Parser parser) const noexcept { XML_ParserFree(parser); }
};

/// Takes the elements <Cyberglove_calibration>, <Joint name=""> and <calib raw_value=""
/// calibrated_value="">. A document type is refused, so that no entity can grow.
class XmlJoints {
public:
  XmlJoints(std::string_view text, std::string_view name)
      : text_(text), name_(name), parser_(XML_ParserCreate(nullptr)) {}

  Result<std::vector<RosJoint>> read() {
    if (!parser_) return Error{Errc::failed, std::string(name_) + ": no memory is left"};
    XML_Parser parser = parser_.get();
    XML_SetUserData(parser, this);
    XML_SetElementHandler(parser, &XmlJoints::begin, &XmlJoints::end);
    XML_SetStartDoctypeDeclHandler(parser, &XmlJoints::doctype);
    const auto state = XML_Parse(parser, text_.data(), static_cast<int>(text_.size()), 1);
    if (wrong_) return *wrong_;
    if (state != XML_STATUS_OK)
      return bad(std::string("is no XML: ") + XML_ErrorString(XML_GetErrorCode(parser)) +
                 "; fix it");
    return std::move(joints_);
  }

private:
  static void begin(void* self, const XML_Char* element, const XML_Char** attributes) {
    static_cast<XmlJoints*>(self)->take(element, attributes);
  }
  static void end(void* self, const XML_Char* /*element*/) {
    --static_cast<XmlJoints*>(self)->depth_;
  }
  static void doctype(void* self, const XML_Char* /*type*/, const XML_Char* /*system*/,
                      const XML_Char* /*public_id*/, int /*has_subset*/) {
    static_cast<XmlJoints*>(self)->stop("has a document type; leave <!DOCTYPE ...> out");
  }

  // Debian 13's Expat advises another function, which Debian 12's does not have.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wdeprecated-declarations"
  std::size_t line() const {
    return static_cast<std::size_t>(XML_GetCurrentLineNumber(parser_.get()));
  }
#pragma GCC diagnostic pop
  Error bad(const std::string& what) const { return bad_line(name_, line(), what); }
  void stop(const std::string& what) {
    if (!wrong_) wrong_ = bad(what);
    XML_StopParser(parser_.get(), XML_FALSE);
  }

  void take(std::string_view element, const XML_Char** attributes) {
    if (wrong_) return;
    if (++depth_ > max_xml_depth) return stop("is nested too deeply");
    if (depth_ == 1 && element != "Cyberglove_calibration")
      return stop("begins with " + in_quotes(element) +
                  "; a calibration begins with <Cyberglove_calibration>");
    if (element == "Joint") return take_joint(attributes);
    if (element == "calib") return take_point(attributes);
    if (depth_ > 1)
      stop(in_quotes(element) + " is not known here; use <Joint name=\"\"> and, in it, <calib "
                                "raw_value=\"\" calibrated_value=\"\"/>");
  }

  static const XML_Char* attribute(const XML_Char** attributes, const char* name) {
    for (; *attributes != nullptr; attributes += 2)
      if (std::strcmp(attributes[0], name) == 0) return attributes[1];
    return nullptr;
  }

  void take_joint(const XML_Char** attributes) {
    const XML_Char* name = attribute(attributes, "name");
    if (name == nullptr || depth_ != 2)
      return stop("<Joint> needs a name, in the outermost element");
    joints_.push_back({name, line(), {}});
  }

  void take_point(const XML_Char** attributes) {
    if (joints_.empty() || depth_ != 3) return stop("<calib> is outside of a <Joint>");
    const auto number = [&](const char* name) -> std::optional<double> {
      const XML_Char* value = attribute(attributes, name);
      return value == nullptr ? std::nullopt : to_finite_number(trimmed(value));
    };
    const auto raw = number("raw_value");
    const auto angle_deg = number("calibrated_value");
    if (!raw || !angle_deg)
      return stop(in_quotes(joints_.back().name) + ": <calib> needs a finite number as " +
                  (raw ? "calibrated_value" : "raw_value"));
    joints_.back().points.push_back({*raw, *angle_deg});
  }

  std::string_view text_;
  std::string_view name_;
  std::unique_ptr<std::remove_pointer_t<XML_Parser>, FreeXmlParser> parser_;
  std::size_t depth_ = 0;
  std::vector<RosJoint> joints_;
  std::optional<Error> wrong_;
};

} // namespace

Result<ImportedCalibration> parse_ros_yaml(std::string_view text, std::string_view name) {
  const auto tree = YamlTree(without_mark(text), name).read();
  if (!tree) return tree.error();
  const YamlNode* list = joints_in(*tree);
  if (list == nullptr || list->kind == YamlNode::Kind::scalar)
    return bad_line(name, tree->line, "has no list cyberglove_calibration; it is another file");
  auto joints = joints_of(*list, name);
  if (!joints) return joints.error();
  return imported_joints(*std::move(joints), name);
}

Result<ImportedCalibration> parse_ros_xml(std::string_view text, std::string_view name) {
  if (text.size() > max_calibration_bytes)
    return Error{Errc::bad_input, std::string(name) + ": is larger than 1 MiB"};
  auto joints = XmlJoints(without_mark(text), name).read();
  if (!joints) return joints.error();
  return imported_joints(*std::move(joints), name);
}

} // namespace nendo::hand
