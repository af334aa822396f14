#pragma once
// A puppet: what each finger does to a model. The paper assigned the displacements of ten
// fingertips to ten functions on a face (2.2, figure 3); so does a puppet file, a short text beside
// the model (README.md of this folder lists its keys). Without points it is a mask file: the
// fingertips then touch the model, of which masks hold parts, and a mirror lets them shape both
// sides.

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/base/side.hpp>
#include <nendo/base/units.hpp>
#include <nendo/deform/supports.hpp>
#include <nendo/deform/surface_field.hpp>
#include <nendo/deform/vertex_mask.hpp>
#include <nendo/hand/skeleton.hpp>

namespace nendo::puppet {

/// A hand at one moment.
struct HandState {
  hand::JointAngles angles;
  hand::HandPose pose;
  Eigen::Isometry3d T_world_wrist = Eigen::Isometry3d::Identity();
};

/// One number of a hand's pose, the input of a puppet. Angles are steadier than places, because a
/// fingertip's place mixes three joints and the wrist. Its name is the hand, a point, and one of
/// - thumb_flexion to little_flexion: what all joints of the finger are bent by, radians;
/// - a joint angle (hand::Angle): thumb_roll, index_mcp_abduction, wrist_yaw and so on, radians;
/// - thumb_tip_x to little_tip_z: the fingertip's place along an axis of the wrist, metres. x goes
///   to the side of the little finger, so that hands that mirror each other have the same signals.
class NENDO_API HandSignal {
public:
  HandSignal() = default;
  /// Returns nothing if there is no such signal.
  static std::optional<HandSignal> named(std::string_view name) noexcept;
  /// Returns the signal of that number; nothing if there is none. Recordings keep the numbers.
  static std::optional<HandSignal> numbered(Side side, std::uint8_t number) noexcept;
  /// Returns the signal of the other hand.
  HandSignal mirrored() const noexcept;

  std::string name() const;
  Side side() const noexcept { return side_; }
  std::uint8_t number() const noexcept { return number_; }
  bool is_angle() const noexcept; ///< radians; otherwise metres
  static constexpr std::uint8_t no_finger = 5;
  /// Returns the finger to which it belongs, 0 thumb to 4 little finger; no_finger: palm or wrist.
  std::uint8_t finger() const noexcept;
  /// Of a fingertip's place: the way along which the signal grows, in the axes of the wrist.
  Eigen::Vector3d direction() const noexcept;
  /// Returns its value. Wait-free; no allocation.
  double of(const HandState& hand) const noexcept;
  friend bool operator==(const HandSignal&, const HandSignal&) = default;

private:
  HandSignal(Side side, std::uint8_t number) noexcept : side_(side), number_(number) {}

  Side side_ = Side::left;
  std::uint8_t number_ = 0; ///< five flexions, then all angles, then 5 tips times 3 axes
};

/// How far apart a place and a start point are.
enum class Distance : std::uint8_t {
  surface, ///< along it, so that a mouth opens
  air,     ///< straight
};

/// A start point of the field.
struct PuppetPoint {
  std::string name;
  std::optional<std::uint32_t> vertex{};        ///< where it is; or else
  Eigen::Vector3d at = Eigen::Vector3d::Zero(); ///< near here, model units
  double radius = 1.0;                          ///< model units, > 0; the largest of `mix`
  bool is_pin = false;                          ///< nothing moves it
  /// It is on the other side of x = 0 of where `vertex` or `at` are: a twin that no file has.
  bool is_mirrored = false;
  std::vector<deform::Support> mix{}; ///< several radii with their weights; empty: one
  /// Returns the mix, or the one radius with a weight of 1.
  std::vector<deform::Support> supports() const {
    return mix.empty() ? std::vector{deform::Support{radius, 1.0}} : mix;
  }
  static constexpr std::size_t max_radii = 4; ///< in one mix
  friend bool operator==(const PuppetPoint&, const PuppetPoint&) = default;
};

/// The rotation axis of a function's points.
struct AxisTurn {
  double degrees = 0.0;
  Eigen::Vector3d axis = Eigen::Vector3d::UnitX(); ///< any length but 0
  Eigen::Vector3d through = Eigen::Vector3d::Zero();
  friend bool operator==(const AxisTurn&, const AxisTurn&) = default;
};

/// What a function does to one point when its value is 1.
struct Move {
  std::size_t point = 0;                            ///< index into Puppet::points
  Eigen::Vector3d vector = Eigen::Vector3d::Zero(); ///< model units
  /// In place of a vector: by how much of Function::turn the point turns. It goes in a straight
  /// line to where that leads.
  std::optional<double> part{};
  friend bool operator==(const Move&, const Move&) = default;
};

/// One thing that the model can do, by a hand.
struct Function {
  std::string name; ///< ARKit's, where it means the same
  HandSignal input;
  double travel = 1.0; ///< change of the signal for a value of 1; may be < 0
  double least = 0.0;  ///< the values between which it stays
  double most = 1.0;
  bool eases = false; ///< towards its limits it slows down, in place of stopping
  std::optional<AxisTurn> turn{};
  std::vector<Move> moves; ///< moves by the turn, then those by vectors
  bool is_twin = false;    ///< made by `mirror`; no file has it
  friend bool operator==(const Function&, const Function&) = default;
};

/// Vertices that belong to no part of the surface with a point, such as teeth.
struct PuppetPart {
  std::optional<deform::Box> inside{}; ///< only those in here, model units; otherwise all
  std::uint32_t first = 0;             ///< only those from this one
  std::uint32_t last = 0xFFFFFFFF;     ///< up to this one
  std::vector<std::size_t> points;     ///< that they follow; empty: the surface
  bool is_affine = true;               ///< deform::FollowingPart::is_affine
  NENDO_API friend bool operator==(const PuppetPart&, const PuppetPart&) noexcept;
};

/// What stays as it is, within a radius of a place.
struct Mask {
  Eigen::Vector3d at = Eigen::Vector3d::Zero();
  double radius = 0.0; ///< model units; vertices within half of it stay, and the rest eases out
  friend bool operator==(const Mask&, const Mask&) = default;
};

/// What makes a hand release its functions and grab them again, besides keys.
enum class ClutchTrigger : std::uint8_t {
  none,
  fist,         ///< all four fingers bent
  pinch,        ///< the tips of thumb and index finger together
  wrist_switch, ///< the glove's, turned on
};

NENDO_API std::string_view name_of(ClutchTrigger means) noexcept; ///< in the file
NENDO_API std::optional<ClutchTrigger> clutch_trigger_named(std::string_view name) noexcept;

struct ClutchOptions {
  std::array<ClutchTrigger, 2> means{}; ///< the left hand's and the right hand's
  double held_s = 0.5;                  ///< how long a gesture must last
  double fist_deg = 200.0;              ///< min bend of each finger in a fist
  double pinch_m = 0.02;                ///< max distance of the tips in a pinch

  friend bool operator==(const ClutchOptions&, const ClutchOptions&) = default;
};

/// At this part of a mask's radius, places move half as far as without it.
inline constexpr double half_of_mask = 0.75;

struct NENDO_API Puppet {
  std::string model; ///< file name, beside the puppet's file
  Distance distance = Distance::surface;
  bool mirrors = false;   ///< `mirror = "x"`: points and functions that are twins follow the others
  double mirror_at = 0.0; ///< x of that plane, model units; 0 if there are points
  std::vector<PuppetPoint> points;
  std::vector<Function> functions;
  std::vector<PuppetPart> parts;
  std::vector<Mask> masks;
  bool inverted = false; ///< the masks select the parts that move, and the rest stays
  ClutchOptions clutch;
  std::string text; ///< the file's text

  /// Returns whether hands play it. Otherwise it has no points, and their fingertips touch the
  /// model.
  bool is_played() const noexcept { return !points.empty(); }
  /// Returns the number of the function with that name.
  std::optional<std::size_t> function_named(std::string_view name) const noexcept;
  /// Compares all but the text.
  NENDO_API friend bool operator==(const Puppet& one, const Puppet& other) noexcept;

  static constexpr std::size_t max_points = 1000; ///< and radii of all points together
  static constexpr std::size_t max_functions = 64;
};

/// Returns "browRight" for "browLeft", and the other way round; other names are their own twins.
NENDO_API std::string twin_of(const std::string& name);

/// Parses a puppet file. What `mirror = "x"` asks for is in the result: points and functions whose
/// names end with Left have twins that end with Right. Error: bad_input, with the line.
NENDO_API Result<Puppet> parse_puppet(std::string_view text, std::string_view name);
/// Reads and parses a file. Errors: those of parse_puppet(), and bad_input if it cannot be read.
NENDO_API Result<Puppet> read_puppet(const std::filesystem::path& path);
/// Returns a file for it, which parse_puppet() makes the same puppet of again. Twins are left to
/// `mirror`. Of the comments of `puppet.text`, those at its beginning are kept.
NENDO_API std::string text_of(const Puppet& puppet);

/// Makes the places of a puppet, and those in its text, count from there: deform::Mesh::offset of
/// its model, or, back to the file's coordinates, minus that. A mirror of x = 0 stays as it is: of
/// a model far from zero it is the plane x = offset, its middle. Without an offset nothing changes.
NENDO_API void count_from(const Eigen::Vector3d& offset, Puppet& puppet);

/// Error: bad_input (the model has no face, or not the vertex of a point).
NENDO_API Result<void> check_fits(const Puppet& puppet, const deform::Mesh& model);
/// Returns where the points are on that model, in their order. It must fit (check_fits()).
NENDO_API std::vector<deform::SurfacePlace> places_on(const Puppet& puppet,
                                                      const deform::Mesh& model);
/// Returns how far each of these vertices follows what moves the model, 0 to 1: by the masks.
/// Empty: there is no mask, and all follow.
NENDO_API Eigen::VectorXd mask_weights(const Puppet& puppet, const deform::Points& vertices);
/// Returns them for a deformer; null: everything moves. Allocates.
NENDO_API std::shared_ptr<const deform::VertexMask> vertex_mask(const Puppet& puppet,
                                                                const deform::BlockLayout& layout,
                                                                const deform::Points& vertices);
/// Returns the x of the plane x = constant in which the model is symmetric: that of the middle of
/// its bounds, if nearly all vertices that are looked at have a mirror image; otherwise 0.
NENDO_API double plane_of_symmetry(const deform::Points& vertices);
/// Returns what the field along that model's surface is made of.
NENDO_API deform::SurfaceSetup surface_setup(const Puppet& puppet, const deform::Mesh& model,
                                             deform::Wendland kernel);

} // namespace nendo::puppet
