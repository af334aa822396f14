#pragma once
// A model as what Foxglove and Lichtblick draw: foxglove_msgs/msg/SceneUpdate.

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "ros/messages.hpp"
#include "ros/types.hpp"

namespace nendo::ros {

inline constexpr MessageType scene_update_type{
    "foxglove_msgs/msg/SceneUpdate",
    "RIHS01_48c640ae3c3c25188e497ddea0ea11c2e189b50db3ef425f2c518d2355e5ff60"};

/// The shape of a run's model, for Foxglove.
inline constexpr Topic model_topic{"/nendo/model", scene_update_type, {}};

/// A surface of triangles. An application replaces an earlier surface with the same id.
struct SceneSurface {
  Time stamp;
  std::string frame_id;
  std::string id;
  std::vector<Point> points;                        ///< metres, in the frame
  std::vector<std::uint32_t> corners;               ///< indices of points, three for each triangle
  std::array<double, 4> colour{1.0, 1.0, 1.0, 1.0}; ///< red, green, blue, opacity: 0 to 1
};

/// Appends a SceneUpdate with the surface as its only entity, as append_cdr() in cdr.hpp does.
void append_cdr(const SceneSurface& surface, std::vector<std::byte>& out);

} // namespace nendo::ros
