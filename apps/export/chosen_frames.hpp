#pragma once
// Selects the frames of a take that are exported. They are a part of the take, either every frame
// or frames at an even rate. At an even rate, the frame nearest to each moment is taken. No frame
// is interpolated. Where frames are missing, the previous one is repeated.

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include <nendo/base/files.hpp>
#include <nendo/base/result.hpp>

#include "takes/frame_source.hpp"

namespace nendo::exporting {

struct Choice {
  double from_s = 0.0;             ///< since the take began
  std::optional<double> to_s{};    ///< nothing means to its end
  std::optional<double> rate_hz{}; ///< nothing means every frame, at its own time
  /// Setting it ends the export. It must outlive the export.
  const std::atomic<bool>* stop = nullptr;
};

/// The rate where nothing else is asked for: a film's, and that of a new scene in Blender.
inline constexpr double animators_rate_hz = 24.0;
inline constexpr double max_export_rate_hz = 10'000.0;
inline constexpr std::uint64_t max_export_frames = 1'000'000;

/// Checks a choice. Errors: usage (impossible times or rate).
Result<void> check(const Choice& choice);

/// What the morph targets of a model are.
enum class MorphBasis : std::uint8_t {
  key_shapes,
  control_vectors, ///< exact
  functions,       ///< those of a puppet; exact
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
  double tolerance = 0.0;  ///< error limit of key shapes per model diagonal; otherwise 0
  double diagonal_m = 0.0; ///< the model's, on the stage
  /// The greatest distance of a vertex from nendo's own shape, over all exported frames, as a
  /// fraction of the model's diagonal.
  double greatest_error = 0.0;
};

/// The report of an export.
struct Exported {
  std::vector<std::string> files;
  std::uint64_t frames = 0;
  double first_s = 0.0; ///< since the take began
  double last_s = 0.0;
  std::uint64_t bytes = 0;             ///< sum over all files
  std::optional<MorphReport> morphs{}; ///< glTF with a model
  std::optional<double> rate_hz{};     ///< nothing means that each frame is at its own time
  bool exact = true;                   ///< nothing was missing in the take up to the last frame
  std::vector<double> begin_s{};       ///< each file's, if the model differs from file to file
  /// deform::Mesh::offset, where the files' places count from there: in model units.
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();
};

class ChosenFrames {
public:
  /// Moves to the first chosen frame. `source` must be new, without a call of next(), and must
  /// outlive this. Blocks. Errors: those of check(); bad_input (no frame in that time), usage (too
  /// many frames).
  static Result<ChosenFrames> make(takes::FrameSource& source, const Choice& choice);

  /// Errors: failed (`stop` was set).
  Result<void> check_stop() const;
  /// Makes the next frame. Returns false if there is none. Errors: those of check_stop(); usage
  /// (more than max_export_frames). Blocks.
  Result<bool> next();
  const flow::Frame& frame() const noexcept { return even_ ? held_ : source_->frame(); }
  /// Returns the time of the frame in seconds since the take began. It never decreases.
  double time_s() const noexcept { return time_s_; }
  double first_s() const noexcept { return first_s_; } ///< time_s() of the first
  /// Returns the number of frames if they are at an even rate.
  std::optional<std::uint64_t> count() const noexcept { return count_; }
  double period_s() const noexcept { return 1.0 / *choice_.rate_hz; } ///< only at an even rate
  const std::optional<double>& rate_hz() const noexcept { return choice_.rate_hz; }
  std::uint64_t made() const noexcept { return made_; } ///< frames that next() made
  /// Makes all frames, and calls `visit` after each. Errors: those of next() and `visit`.
  template <class Visit>
  Result<void> for_each(const Visit& visit) {
    for (;;) {
      const auto more = next();
      if (!more) return more.error();
      if (!*more) return {};
      if (auto visited = visit(); !visited) return visited;
    }
  }
  /// Returns the report of an export of the frames so far, without its files.
  Exported report() const;

  /// Returns the puppet of the frame; nothing if the hands touch the model.
  std::optional<takes::PlayedPuppet> puppet() const { return even_ ? puppet_ : source_->puppet(); }

  const takes::FrameSource& source() const noexcept { return *source_; }
  /// Writes the latest frame's shape to `out`, 3 by #vertices, in the mesh's order and in model
  /// units.
  void vertices(deform::Points& out) const {
    source_->layout(frame().model).unpack(frame().shape, out);
  }

private:
  ChosenFrames(takes::FrameSource& source, const Choice& choice)
      : source_(&source), choice_(choice) {}
  bool is_nearer(double moment_s) const;
  void hold_nearest(double moment_s);

  takes::FrameSource* source_;
  Choice choice_;
  bool even_ = false;     ///< at a rate
  bool is_ahead_ = false; ///< the source's frame has not been shown
  double first_s_ = 0.0;
  double time_s_ = 0.0;
  std::optional<std::uint64_t> count_;
  std::uint64_t made_ = 0;
  flow::Frame held_;
  double held_s_ = 0.0;                         ///< the own time of held_
  std::optional<takes::PlayedPuppet> puppet_{}; ///< the puppet of held_
};

/// Writes the latest frame to the file. Before the first frame it also writes the file's header.
using PutFrame = std::function<Result<void>(FileReplacement& file)>;

/// Writes the file atomically and replaces an existing one: each frame by `put`, and after the last
/// one what follows by `put_end`, if there is such a function. Blocks. Errors: those of
/// ChosenFrames::next(), both functions and FileReplacement.
Result<Exported> export_to_one_file(ChosenFrames& frames, const std::filesystem::path& path,
                                    const PutFrame& put, const PutFrame& put_end = {});

} // namespace nendo::exporting
