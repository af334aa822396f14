#include <nendo/hand/calibration_poses.hpp>

#include <algorithm>

#include <nendo/base/units.hpp>

namespace nendo::hand {
namespace {

// Degrees, and how far wearers are off. The angles of bent joints are means of active ranges of
// motion (American Academy of Orthopaedic Surgeons: MCP 90, PIP 100, DIP 80 to 90, thumb MCP 50,
// IP 80, wrist 70 to 80, 20 and 30), a little below, since calibration must not strain the wearer.
struct Asked {
  double angle_deg;
  double deviation_deg;
};
constexpr Asked straight{0, 5};
constexpr Asked mcp_bent{87, 6};
constexpr Asked pip_bent{98, 6};
constexpr Asked dip_bent{65, 8};
constexpr Asked side_by_side{0, 2};
constexpr Asked bent_side_by_side{0, 3};

/// Writes one pose down. The fingers are counted from the index finger.
class Described {
public:
  constexpr Described(std::string_view name, std::string_view instruction) {
    pose_.name = name;
    pose_.instruction = instruction;
  }
  constexpr Described& of(Sensor sensor, Asked asked) {
    const bool bent = asked.angle_deg > 8.0 || asked.angle_deg < -8.0;
    pose_.assumed[index_of(sensor)] = {from_degrees(asked.angle_deg),
                                       from_degrees(asked.deviation_deg), bent};
    return *this;
  }
  constexpr Described& finger(std::size_t number, Asked mcp, Asked pip, Asked dip) {
    const auto& sensors = finger_sensors[number];
    return of(sensors[0], mcp).of(sensors[1], pip).of(sensors[2], dip);
  }
  constexpr Described& fingers(Asked mcp, Asked pip, Asked dip) {
    for (std::size_t number = 0; number < 4; ++number)
      finger(number, mcp, pip, dip);
    return *this;
  }
  /// Palm and first phalanx on a table, the others pressed against its side.
  constexpr Described& over_edge(std::size_t number) {
    finger(number, straight, {90, 4}, straight);
    pose_.assumed[index_of(Sensor::index_pip) + 4 * number].by_feel = false;
    return *this;
  }
  /// The first `extended` fingers straight, the others as in a fist, but less surely.
  constexpr Described& counting(std::size_t extended) {
    for (std::size_t number = 0; number < 4; ++number) {
      number < extended ? finger(number, straight, straight, straight)
                        : finger(number, {85, 8}, {97, 7}, {60, 12});
    }
    return *this;
  }
  constexpr Described& gaps(Asked index_middle, Asked middle_ring, Asked ring_little) {
    return of(Sensor::index_middle_abduction, index_middle)
        .of(Sensor::middle_ring_abduction, middle_ring)
        .of(Sensor::ring_little_abduction, ring_little);
  }
  constexpr Described& closed(Asked asked) { return gaps(asked, asked, asked); }
  constexpr Described& thumb(Asked roll, Asked abduction) {
    return of(Sensor::thumb_roll, roll).of(Sensor::thumb_abduction, abduction);
  }
  constexpr Described& thumb_bends(Asked mcp, Asked ip) {
    return of(Sensor::thumb_mcp, mcp).of(Sensor::thumb_ip, ip);
  }
  constexpr Described& arch(Asked asked) { return of(Sensor::palm_arch, asked); }
  constexpr Described& wrist(Asked pitch, Asked yaw) {
    return of(Sensor::wrist_pitch, pitch).of(Sensor::wrist_yaw, yaw);
  }
  constexpr Described& touching(Touch touch) {
    pose_.touch = touch;
    return *this;
  }
  constexpr operator CalibrationPose() const { return pose_; }

private:
  CalibrationPose pose_;
};

constexpr Described flat_fingers(std::string_view name, std::string_view instruction) {
  return Described(name, instruction)
      .fingers(straight, straight, straight)
      .closed(side_by_side)
      .arch({0, 4});
}

constexpr std::array<CalibrationPose, pose_count> poses{{
    flat_fingers("flat", "Lay the hand flat on the table, fingers closed, thumb beside them.")
        .thumb({0, 8}, {0, 6})
        .thumb_bends({0, 5}, {0, 5})
        .wrist({0, 5}, {0, 5}),
    Described("fist", "Make a fist, the thumb over the fingers.")
        .fingers(mcp_bent, pip_bent, dip_bent)
        .closed(bent_side_by_side)
        .thumb_bends({40, 12}, {45, 15}),
    Described("spread", "Flat on the table again, and spread the fingers as far as is easy.")
        .fingers(straight, straight, straight)
        .gaps({20, 6}, {15, 6}, {20, 6})
        .thumb_bends({0, 8}, {0, 8})
        .arch({0, 5})
        .wrist({0, 6}, {0, 6}),
    flat_fingers("thumb_out", "Still flat: close the fingers, and point the thumb out to the side.")
        .thumb({0, 8}, {45, 8})
        .thumb_bends({0, 6}, {0, 6})
        .wrist({0, 6}, {0, 6}),
    flat_fingers("thumb_up", "Fingers straight, and point the thumb away from the palm.")
        .thumb({75, 8}, {45, 8})
        .thumb_bends({0, 8}, {0, 8}),
    Described("thumb_across", "Fingers straight; touch the base of the little finger.")
        .fingers(straight, straight, straight)
        .touching({Joint::little_proximal, 0.006}),
    flat_fingers("thumb_bent", "Fingers straight; bend both joints of the thumb.")
        .thumb_bends({50, 7}, {72, 8}),
    Described("table_top", "Keep the fingers straight and closed, bent at the knuckles only.")
        .fingers(mcp_bent, straight, straight)
        .closed({0, 3})
        .arch({0, 6}),
    Described("hook", "Make a hook: knuckles straight, fingers bent.")
        .fingers({0, 6}, pip_bent, dip_bent)
        .closed(bent_side_by_side),
    Described("straight_fist", "Bend knuckles and middle joints; keep the last joints straight.")
        .fingers(mcp_bent, {95, 7}, {3, 8})
        .closed(bent_side_by_side),
    Described("edge_index", "Palm on the table; index and middle finger bent down over its edge.")
        .over_edge(0)
        .over_edge(1),
    Described("edge_little", "The same with ring and little finger: press them to its side.")
        .over_edge(2)
        .over_edge(3),
    Described("point", "Make a fist, the index finger straight.")
        .counting(1)
        .closed(bent_side_by_side),
    Described("two", "Index and middle finger straight and closed, the others in the fist.")
        .counting(2)
        .gaps({0, 3}, bent_side_by_side, bent_side_by_side),
    Described("three", "Index, middle and ring finger straight and closed, the last one bent.")
        .counting(3)
        .gaps({0, 3}, {0, 3}, bent_side_by_side),
    Described("pinch_index", "Touch the tip of the index finger with the thumb, making a ring.")
        .touching({Joint::index_tip}),
    Described("pinch_index_flat", "Touch it again, the index finger's last two joints straight.")
        .of(Sensor::index_pip, {15, 12})
        .of(Sensor::index_dip, {5, 10})
        .touching({Joint::index_tip}),
    Described("pinch_middle", "Touch the tip of the middle finger with the thumb.")
        .touching({Joint::middle_tip}),
    Described("pinch_ring", "Touch the tip of the ring finger with the thumb.")
        .touching({Joint::ring_tip}),
    Described("pinch_little", "Touch the tip of the little finger with the thumb.")
        .arch({15, 8})
        .touching({Joint::little_tip}),
    Described("wrist_down", "Bend the wrist towards the palm.").wrist({70, 8}, {0, 6}),
    Described("wrist_back", "Bend the wrist towards the back of the hand.").wrist({-60, 8}, {0, 6}),
    Described("wrist_inwards", "Turn the hand at the wrist towards the thumb.")
        .wrist({0, 6}, {20, 5}),
    Described("wrist_outwards", "Turn the hand at the wrist towards the little finger.")
        .wrist({0, 6}, {-30, 6}),
}};

constexpr std::array touch_up{PoseId::flat,         PoseId::fist,       PoseId::pinch_index,
                              PoseId::pinch_middle, PoseId::pinch_ring, PoseId::pinch_little};
constexpr std::array quick{PoseId::flat, PoseId::fist};
constexpr auto full = [] {
  std::array<PoseId, pose_count> ids{};
  for (std::size_t at = 0; at < pose_count; ++at)
    ids[at] = static_cast<PoseId>(at);
  return ids;
}();

// A thumb's roll and abduction are asked for by few poses, and people scatter by five degrees.
constexpr std::array again{PoseId::fist,        PoseId::thumb_bent, PoseId::edge_index,
                           PoseId::edge_little, PoseId::flat,       PoseId::thumb_out,
                           PoseId::thumb_up,    PoseId::spread,     PoseId::thumb_out,
                           PoseId::thumb_up};
constexpr auto takes = [] {
  std::array<PoseId, full.size() + again.size()> ids{};
  std::copy(again.begin(), again.end(), std::copy(full.begin(), full.end(), ids.begin()));
  return ids;
}();

} // namespace

const CalibrationPose& pose_of(PoseId id) noexcept {
  return poses[std::min(static_cast<std::size_t>(id), pose_count - 1)];
}

std::optional<PoseId> pose_named(std::string_view name) noexcept {
  for (const PoseId id : full) {
    if (pose_of(id).name == name) return id;
  }
  return std::nullopt;
}

std::span<const PoseId> quick_poses() noexcept {
  return quick;
}

std::span<const PoseId> touch_up_poses() noexcept {
  return touch_up;
}

std::span<const PoseId> full_poses() noexcept {
  return full;
}

std::span<const PoseId> full_takes() noexcept {
  return takes;
}

} // namespace nendo::hand
