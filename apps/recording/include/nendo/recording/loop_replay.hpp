#pragma once
// Feeds a loop from a recording, tick by tick and without a clock. The same recording gives the
// same shape, bit for bit, on the same build and the same kind of processor.

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string_view>
#include <vector>

#include <nendo/flow/input_script.hpp>
#include <nendo/recording/take_reader.hpp>

namespace nendo::recording {

/// The message, after the file's name, about a recording from which no shape can be made.
inline constexpr std::string_view without_loop =
    "gloves were recorded, but no loop that shapes a model; shape one with `nendo run --right "
    "replay:FILE`";

/// Returns the options of the recorded loop, with its puppet on `model`, and without rings. Error:
/// bad_input, as from LoopReplay::make(), except that it does not check whether the hands can grab.
NENDO_API Result<flow::LoopOptions> loop_options_of(const Setup& setup, const deform::Mesh& model);

class NENDO_API LoopReplay {
public:
  /// Makes the recorded loop in its first state, over `model`, which should be the recorded one
  /// (LoopSetup::mesh_sum). Error: bad_input (no loop was recorded, the data about the loop is
  /// damaged, or the hands cannot grab the model).
  static Result<std::unique_ptr<LoopReplay>> make(const Setup& setup, const deform::Mesh& model);

  /// Feeds the next entry of the recording. Returns true if it was a tick, which has then run.
  bool feed(const Entry& entry) noexcept;
  /// Returns true if no entry was missing so far, so that the shape equals that of the recorded
  /// loop.
  bool is_exact() const noexcept { return exact_; }

  flow::DeformLoop& loop() noexcept { return *loop_; }

private:
  LoopReplay() = default;
  void take(const RecordedSample& sample) noexcept;
  void take(const RecordedPose& recorded) noexcept;
  bool follow(const flow::ChangeModel& change);
  bool follow(const PuppetChange& change);

  std::vector<std::unique_ptr<SampleRing>> rings_;
  std::array<std::unique_ptr<PoseRing>, 2> poses_; ///< in the order of Side
  flow::CommandRing commands_{2048};
  std::unique_ptr<flow::DeformLoop> loop_;
  std::map<std::uint32_t, std::uint32_t>
      versions_; ///< the model's versions, by their recorded numbers
  std::map<std::uint32_t, std::uint32_t> puppets_; ///< indexed by recorded numbers
  bool exact_ = true;
};

struct TakeInput {
  Setup setup;
  /// The loop's input: all samples, and all commands except those that the next loop generates
  /// itself (HoldStill, and ChangeModel to an existing version).
  std::unique_ptr<flow::InputScript> script;
  /// The puppets of flow::ChangePuppet, by number. A missing number refers to the puppet with which
  /// the recording began.
  std::map<std::uint32_t, std::shared_ptr<const RecordedPuppet>> puppets{};
  std::vector<driver::RecordCounts> sent; ///< one per glove
  bool is_exact = true;                   ///< no entry is missing
};

/// Reads a recording of a loop. Blocks, and allocates 160 bytes per sample. Errors: bad_input (as
/// from TakeReader::open(); or no loop was recorded, or it has no tick).
NENDO_API Result<TakeInput> read_take_input(const std::filesystem::path& path);

} // namespace nendo::recording
