#include <cstring>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include <expat.h>

#include <nendo/base/text.hpp>
#include <nendo/hand/calibration_exchange.hpp>

#include "calibration_check.hpp"
#include "ros_joints.hpp"

namespace nendo::hand {
namespace {

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

Result<ImportedCalibration> parse_ros_xml(std::string_view text, std::string_view name) {
  if (text.size() > max_calibration_bytes)
    return Error{Errc::bad_input, std::string(name) + ": is larger than 1 MiB"};
  auto joints = XmlJoints(without_mark(text), name).read();
  if (!joints) return joints.error();
  return imported_joints(*std::move(joints), name);
}

} // namespace nendo::hand
