#include "ros/scene.hpp"

#include "ros/cdr_writer.hpp"

namespace nendo::ros {

void append_cdr(const SceneSurface& surface, std::vector<std::byte>& out) {
  constexpr int lists_before = 6; // metadata, arrows, cubes, spheres, cylinders, lines
  constexpr int lists_after = 2;  // labels, models of files
  CdrWriter writer(out);
  const auto put_none = [&writer](int lists) {
    for (int at = 0; at < lists; ++at)
      writer.put_none();
  };
  const auto put_one = [&writer] { writer.put(std::uint32_t{1}); };
  put_none(1); // deletions
  put_one();   // entities
  writer.put(Header{surface.stamp, surface.frame_id});
  writer.put(std::string_view(surface.id));
  writer.put(std::int32_t{0}); // lifetime, without end
  writer.put(std::uint32_t{0});
  writer.put(std::uint8_t{0}); // frame_locked
  put_none(lists_before);
  put_one(); // triangles
  writer.put(Pose{});
  writer.put(surface.points);
  for (const double part : surface.colour)
    writer.put(part);
  put_none(1); // colours of points
  writer.put(surface.corners);
  put_none(lists_after);
}

} // namespace nendo::ros
