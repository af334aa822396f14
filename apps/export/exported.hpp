#pragma once
// The report of an export.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

namespace nendo::exporting {

/// What the morph targets of a model are.
enum class MorphBasis : std::uint8_t {
  key_shapes,
  control_vectors, ///< exact
  functions,       ///< of a puppet; exact
};

/// "key shapes", "control vectors" or "functions".
std::string_view name_of(MorphBasis basis) noexcept;

/// How a model's motion became morph targets.
struct MorphReport {
  MorphBasis basis = MorphBasis::key_shapes;
  bool has_puppet = false; ///< in the take, whatever the basis is
  std::size_t targets = 0;
  std::size_t models = 1;  ///< one after another, where the model or its puppet changed
  std::size_t keys = 0;    ///< moments between which weights are interpolated
  double tolerance = 0.0;  ///< of key shapes, as a fraction of the model's diagonal; otherwise 0
  double diagonal_m = 0.0; ///< of the model, on the stage
  /// The greatest distance of a vertex from nendo's own shape, over all exported frames, as a
  /// fraction of the model's diagonal.
  double greatest_error = 0.0;
};

struct Exported {
  std::vector<std::string> files;
  std::uint64_t frames = 0;
  double first_s = 0.0; ///< since the take began
  double last_s = 0.0;
  std::uint64_t bytes = 0;             ///< of all files
  std::optional<MorphReport> morphs{}; ///< glTF with a model
  std::optional<double> rate_hz{};     ///< nothing means that each frame is at its own time
  bool exact = true;                   ///< nothing was missing in the take up to the last frame
  std::vector<double> begin_s{};       ///< of each file, if the model differs from file to file
  /// deform::Mesh::offset, where the files' places count from there: in model units.
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();
};

} // namespace nendo::exporting
