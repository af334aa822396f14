#pragma once
// A puppet: a mapping from fingers to motions of a model. The paper assigned the displacements of
// ten fingertips to ten functions on a face (2.2, figure 3); so does a puppet file, a short text
// beside the model (apps/puppet/README.md lists its keys). Without points it is a mask file:
// fingertips then touch the model, masks protect regions of it, and a mirror makes fingertips shape
// both sides.

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
#include <nendo/deform/supports.hpp>
#include <nendo/deform/surface_field.hpp>
#include <nendo/deform/vertex_mask.hpp>
#include <nendo/hand/skeleton.hpp>

namespace nendo::puppet {

/// The state of a hand at one time.
struct HandState {
  hand::JointAngles angles;
  hand::HandPose pose;
  Eigen::Isometry3d T_world_wrist = Eigen::Isometry3d::Identity();
};

/// One scalar of a hand's pose, the input of a puppet. Angles are steadier than positions, because
/// a fingertip's position depends on three joints and the wrist. Its name is the hand, a point, and
/// one of
/// - thumb_flexion to little_flexion: total flexion of the finger's joints, radians;
/// - a joint angle (hand::Angle): thumb_roll, index_mcp_abduction, wrist_yaw and so on, radians;
/// - thumb_tip_x to little_tip_z: the fingertip's coordinate on an axis of the wrist, metres. x
///   points to the little finger's side, so that mirrored hands have equal signals.
class NENDO_API HandSignal {
public:
  HandSignal() = default;
  /// Returns nullopt if there is no such signal.
  static std::optional<HandSignal> named(std::string_view name) noexcept;
  /// Returns the signal with this number; nullopt if there is none. Recordings store the numbers.
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
  /// For a fingertip's coordinate: the direction in which the signal increases, in the wrist frame.
  Eigen::Vector3d direction() const noexcept;
  /// Returns its value. Wait-free; no allocation.
  double of(const HandState& hand) const noexcept;
  friend bool operator==(const HandSignal&, const HandSignal&) = default;

private:
  HandSignal(Side side, std::uint8_t number) noexcept : side_(side), number_(number) {}

  Side side_ = Side::left;
  std::uint8_t number_ = 0; ///< five flexions, then all angles, then 5 tips times 3 axes
};

/// The path along which distances from a start point are measured.
enum class Distance : std::uint8_t {
  surface,   ///< along the surface, so that a mouth can open
  euclidean, ///< straight through space
};

/// A start point of the field.
struct PuppetPoint {
  std::string name;
  std::optional<std::uint32_t> vertex{};        ///< its vertex; nullopt: the point is at `at`
  Eigen::Vector3d at = Eigen::Vector3d::Zero(); ///< the surface position nearest to it, model units
  double radius = 1.0;                          ///< model units, > 0; the largest of `mix`
  bool is_pin = false;                          ///< no function moves it
  /// True: it is the mirror image, about x = 0, of `vertex` or `at`: a twin, which files do not
  /// store.
  bool is_mirrored = false;
  std::vector<deform::Support> mix{}; ///< several radii with weights; empty: only `radius`
  /// Returns the mix, or the one radius with a weight of 1.
  std::vector<deform::Support> supports() const {
    return mix.empty() ? std::vector{deform::Support{radius, 1.0}} : mix;
  }
  static constexpr std::size_t max_radii = 4; ///< max number of radii in a mix
  friend bool operator==(const PuppetPoint&, const PuppetPoint&) = default;
};

/// The rotation axis of a function's points.
struct AxisTurn {
  double degrees = 0.0;
  Eigen::Vector3d axis = Eigen::Vector3d::UnitX(); ///< any length but 0
  Eigen::Vector3d through = Eigen::Vector3d::Zero();
  friend bool operator==(const AxisTurn&, const AxisTurn&) = default;
};

/// The motion of one point by a function of value 1.
struct Move {
  std::size_t point = 0;                            ///< index into Puppet::points
  Eigen::Vector3d vector = Eigen::Vector3d::Zero(); ///< model units
  /// Replaces the vector: the fraction of Function::turn by which the point rotates. The point
  /// moves straight to the rotated position.
  std::optional<double> part{};
  friend bool operator==(const Move&, const Move&) = default;
};

/// A motion of the model, controlled by a hand.
struct Function {
  std::string name; ///< ARKit's name, if the meaning is the same
  HandSignal input;
  double travel = 1.0; ///< change of the signal for a value of 1; may be < 0
  double least = 0.0;  ///< limits of the value: `least` to `most`
  double most = 1.0;
  bool eases = false; ///< slows down near its limits instead of stopping
  std::optional<AxisTurn> turn{};
  std::vector<Move> moves; ///< first the moves by `turn`, then the moves by vectors
  bool is_twin = false;    ///< made by `mirror`; not stored in files
  friend bool operator==(const Function&, const Function&) = default;
};

/// Vertices of parts of the surface without points, such as teeth.
struct PuppetPart {
  std::optional<deform::Box> inside{}; ///< only vertices in this box, model units; nullopt: all
  std::uint32_t first = 0;             ///< first vertex
  std::uint32_t last = 0xFFFFFFFF;     ///< last vertex, inclusive
  std::vector<std::size_t> points;     ///< points that they follow; empty: the surface
  bool is_affine = true;               ///< deform::FollowingPart::is_affine
  friend bool operator==(const PuppetPart&, const PuppetPart&) = default;
};

/// Protects the vertices within a radius of a position.
struct Mask {
  Eigen::Vector3d at = Eigen::Vector3d::Zero();
  double radius = 0.0; ///< model units; full protection within half of it, then decreasing
  friend bool operator==(const Mask&, const Mask&) = default;
};

/// The trigger, besides keys, that makes a hand release its functions and grab them again.
enum class ClutchTrigger : std::uint8_t {
  none,
  fist,         ///< all four fingers bent
  pinch,        ///< the tips of thumb and index finger together
  wrist_switch, ///< the glove's switch, turned on
};

NENDO_API std::string_view name_of(ClutchTrigger means) noexcept; ///< name in the file
NENDO_API std::optional<ClutchTrigger> clutch_trigger_named(std::string_view name) noexcept;

struct ClutchOptions {
  std::array<ClutchTrigger, 2> means{}; ///< triggers of the left and the right hand
  double held_s = 0.5;                  ///< min duration of a gesture
  double fist_deg = 200.0;              ///< min bend of each finger in a fist
  double pinch_m = 0.02;                ///< max distance of the tips in a pinch

  friend bool operator==(const ClutchOptions&, const ClutchOptions&) = default;
};

/// At this fraction of a mask's radius, vertices move half as far as without the mask.
inline constexpr double half_of_mask = 0.75;

struct NENDO_API Puppet {
  std::string model; ///< name of the model file, in the folder of the puppet's file
  Distance distance = Distance::surface;
  bool mirrors = false;   ///< `mirror = "x"`: twins follow the other points and functions
  double mirror_at = 0.0; ///< x of the mirror plane, model units; 0 if there are points
  std::vector<PuppetPoint> points;
  std::vector<Function> functions;
  std::vector<PuppetPart> parts;
  std::vector<Mask> masks;
  bool inverted = false; ///< the masks select the vertices that move; all others are protected
  ClutchOptions clutch;
  std::string text; ///< the file's text

  /// Returns whether hands play the puppet. Otherwise it has no points, and fingertips touch the
  /// model.
  bool is_played() const noexcept { return !points.empty(); }
  /// Returns the index of the function with this name.
  std::optional<std::size_t> function_named(std::string_view name) const noexcept;
  /// Compares all but the text.
  NENDO_API friend bool operator==(const Puppet& one, const Puppet& other) noexcept;

  static constexpr std::size_t max_points = 1000; ///< also of all radii together
  static constexpr std::size_t max_functions = 64;
};

/// Returns "browRight" for "browLeft", and the other way round; other names are their own twins.
NENDO_API std::string twin_of(const std::string& name);

/// Parses a puppet file. `mirror = "x"` is expanded in the result: points and functions whose names
/// end with Left have twins that end with Right. Error: bad_input, with the line.
NENDO_API Result<Puppet> parse_puppet(std::string_view text, std::string_view name);
/// Reads and parses a file. Errors: those of parse_puppet(), and bad_input if it cannot be read.
NENDO_API Result<Puppet> read_puppet(const std::filesystem::path& path);
/// Returns the text of a file that parse_puppet() parses to the same puppet. Twins are omitted,
/// because `mirror` generates them. Of the comments of `puppet.text`, only the leading ones are
/// kept.
NENDO_API std::string text_of(const Puppet& puppet);

/// Subtracts an offset from the positions of a puppet and of its text: deform::Mesh::offset of its
/// model, or its negative to restore the file's coordinates. A mirror about x = 0 is unchanged: for
/// a model far from the origin, it is the plane x = offset, its centre. Offset 0 changes nothing.
NENDO_API void count_from(const Eigen::Vector3d& offset, Puppet& puppet);

/// Checks a puppet against a model. Error: bad_input (the model has no face, or lacks a point's
/// vertex).
NENDO_API Result<void> check_fits(const Puppet& puppet, const deform::Mesh& model);
/// Returns the positions of the points on the model, in order. The puppet must fit (check_fits()).
NENDO_API std::vector<deform::SurfacePosition> positions_on(const Puppet& puppet,
                                                            const deform::Mesh& model);
/// Returns the weight of each vertex by the masks, from 0 (protected) to 1 (free). Empty: there is
/// no mask.
NENDO_API Eigen::VectorXd mask_weights(const Puppet& puppet, const deform::Points& vertices);
/// Returns these weights for a deformer; null: all vertices are free. Allocates.
NENDO_API std::shared_ptr<const deform::VertexMask> vertex_mask(const Puppet& puppet,
                                                                const deform::BlockLayout& layout,
                                                                const deform::Points& vertices);
/// Returns the x of the model's symmetry plane x = constant: the centre of its bounds if nearly all
/// sampled vertices have a mirror image; otherwise 0.
NENDO_API double plane_of_symmetry(const deform::Points& vertices);
/// Returns the setup of the puppet's field along the model's surface.
NENDO_API deform::SurfaceSetup surface_setup(const Puppet& puppet, const deform::Mesh& model,
                                             deform::Wendland kernel);

} // namespace nendo::puppet
