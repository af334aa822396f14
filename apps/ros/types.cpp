#include "ros/types.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <vector>

namespace nendo::ros {
namespace {

struct Definition {
  std::string_view name; ///< as fields of other definitions have it
  std::string_view fields;
};

constexpr std::array definitions{
    Definition{"builtin_interfaces/Time", "int32 sec\nuint32 nanosec\n"},
    Definition{"std_msgs/Header", "builtin_interfaces/Time stamp\nstring frame_id\n"},
    Definition{"std_msgs/String", "string data\n"},
    Definition{"sensor_msgs/JointState", "std_msgs/Header header\nstring[] name\n"
                                         "float64[] position\nfloat64[] velocity\n"
                                         "float64[] effort\n"},
    Definition{"geometry_msgs/Vector3", "float64 x\nfloat64 y\nfloat64 z\n"},
    Definition{"geometry_msgs/Point", "float64 x\nfloat64 y\nfloat64 z\n"},
    Definition{"geometry_msgs/Quaternion", "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n"},
    Definition{"geometry_msgs/Transform", "geometry_msgs/Vector3 translation\n"
                                          "geometry_msgs/Quaternion rotation\n"},
    Definition{"geometry_msgs/Pose", "geometry_msgs/Point position\n"
                                     "geometry_msgs/Quaternion orientation\n"},
    Definition{"geometry_msgs/TransformStamped", "std_msgs/Header header\nstring child_frame_id\n"
                                                 "geometry_msgs/Transform transform\n"},
    Definition{"geometry_msgs/PoseArray", "std_msgs/Header header\ngeometry_msgs/Pose[] poses\n"},
    Definition{"builtin_interfaces/Duration", "int32 sec\nuint32 nanosec\n"},
    Definition{"foxglove_msgs/SceneUpdate", "foxglove_msgs/SceneEntityDeletion[] deletions\n"
                                            "foxglove_msgs/SceneEntity[] entities\n"},
    Definition{"foxglove_msgs/SceneEntityDeletion", "builtin_interfaces/Time timestamp\n"
                                                    "uint8 type\nstring id\n"},
    Definition{"foxglove_msgs/SceneEntity", "builtin_interfaces/Time timestamp\nstring frame_id\n"
                                            "string id\nbuiltin_interfaces/Duration lifetime\n"
                                            "bool frame_locked\n"
                                            "foxglove_msgs/KeyValuePair[] metadata\n"
                                            "foxglove_msgs/ArrowPrimitive[] arrows\n"
                                            "foxglove_msgs/CubePrimitive[] cubes\n"
                                            "foxglove_msgs/SpherePrimitive[] spheres\n"
                                            "foxglove_msgs/CylinderPrimitive[] cylinders\n"
                                            "foxglove_msgs/LinePrimitive[] lines\n"
                                            "foxglove_msgs/TriangleListPrimitive[] triangles\n"
                                            "foxglove_msgs/TextPrimitive[] texts\n"
                                            "foxglove_msgs/ModelPrimitive[] models\n"},
    Definition{"foxglove_msgs/KeyValuePair", "string key\nstring value\n"},
    Definition{"foxglove_msgs/Color", "float64 r\nfloat64 g\nfloat64 b\nfloat64 a\n"},
    Definition{"foxglove_msgs/ArrowPrimitive",
               "geometry_msgs/Pose pose\nfloat64 shaft_length\n"
               "float64 shaft_diameter\nfloat64 head_length\n"
               "float64 head_diameter\nfoxglove_msgs/Color color\n"},
    Definition{"foxglove_msgs/CubePrimitive",
               "geometry_msgs/Pose pose\ngeometry_msgs/Vector3 size\n"
               "foxglove_msgs/Color color\n"},
    Definition{"foxglove_msgs/SpherePrimitive", "geometry_msgs/Pose pose\n"
                                                "geometry_msgs/Vector3 size\n"
                                                "foxglove_msgs/Color color\n"},
    Definition{"foxglove_msgs/CylinderPrimitive",
               "geometry_msgs/Pose pose\n"
               "geometry_msgs/Vector3 size\nfloat64 bottom_scale\n"
               "float64 top_scale\nfoxglove_msgs/Color color\n"},
    Definition{"foxglove_msgs/LinePrimitive", "uint8 type\ngeometry_msgs/Pose pose\n"
                                              "float64 thickness\nbool scale_invariant\n"
                                              "geometry_msgs/Point[] points\n"
                                              "foxglove_msgs/Color color\n"
                                              "foxglove_msgs/Color[] colors\nuint32[] indices\n"},
    Definition{"foxglove_msgs/TriangleListPrimitive", "geometry_msgs/Pose pose\n"
                                                      "geometry_msgs/Point[] points\n"
                                                      "foxglove_msgs/Color color\n"
                                                      "foxglove_msgs/Color[] colors\n"
                                                      "uint32[] indices\n"},
    Definition{"foxglove_msgs/TextPrimitive", "geometry_msgs/Pose pose\nbool billboard\n"
                                              "float64 font_size\nbool scale_invariant\n"
                                              "foxglove_msgs/Color color\nstring text\n"},
    Definition{"foxglove_msgs/ModelPrimitive",
               "geometry_msgs/Pose pose\ngeometry_msgs/Vector3 scale\n"
               "foxglove_msgs/Color color\nbool override_color\n"
               "string url\nstring media_type\nuint8[] data\n"},
    Definition{"tf2_msgs/TFMessage", "geometry_msgs/TransformStamped[] transforms\n"},
    Definition{"diagnostic_msgs/KeyValue", "string key\nstring value\n"},
    Definition{"diagnostic_msgs/DiagnosticStatus", "byte level\nstring name\nstring message\n"
                                                   "string hardware_id\n"
                                                   "diagnostic_msgs/KeyValue[] values\n"},
    Definition{"diagnostic_msgs/DiagnosticArray",
               "std_msgs/Header header\ndiagnostic_msgs/DiagnosticStatus[] status\n"},
};

/// Returns null for a type of numbers or strings.
const Definition* definition_of(std::string_view name) {
  const auto* const found = std::ranges::find(definitions, name, &Definition::name);
  return found == definitions.end() ? nullptr : found;
}

/// Appends the types that the definition contains, each once, and those in them after it.
void collect(const Definition& definition, std::vector<const Definition*>& all) {
  std::string_view rest = definition.fields;
  while (!rest.empty()) {
    const Definition* const inner = definition_of(rest.substr(0, rest.find_first_of(" [")));
    rest.remove_prefix(rest.find('\n') + 1);
    if (inner == nullptr || std::ranges::count(all, inner) > 0) continue;
    all.push_back(inner);
    collect(*inner, all);
  }
}

} // namespace

std::string schema_of(const MessageType& type) {
  constexpr std::string_view middle = "/msg/";
  const std::size_t at = type.name.find(middle);
  const Definition* const own = definition_of(std::string(type.name.substr(0, at)) + "/" +
                                              std::string(type.name.substr(at + middle.size())));
  assert(own != nullptr);
  std::string text(own->fields);
  std::vector<const Definition*> inner;
  collect(*own, inner);
  for (const Definition* one : inner)
    text.append(80, '=').append("\nMSG: ").append(one->name).append("\n").append(one->fields);
  return text;
}

std::string offered_qos_profiles(const Qos& qos) {
  constexpr std::string_view infinite =
      ":\n    sec: 9223372036\n    nsec: 854775807\n"; // RMW_DURATION_INFINITE
  std::string text = "- history: 1\n  depth: " + std::to_string(qos.depth) +
                     "\n  reliability: 1\n  durability: " + (qos.is_transient_local ? "1" : "2") +
                     "\n  deadline";
  text.append(infinite).append("  lifespan").append(infinite).append("  liveliness: 1\n");
  text.append("  liveliness_lease_duration").append(infinite);
  return text + "  avoid_ros_namespace_conventions: false";
}

} // namespace nendo::ros
