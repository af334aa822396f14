#pragma once
// A loop that is fed from a recording, tick by tick and without a clock: the same recording gives
// the same shape, bit for bit, on the same build and the same kind of processor.

#include <memory>
#include <string_view>
#include <vector>

#include <nendo/recording/take_reader.hpp>

namespace nendo::recording {

/// What is wrong with a recording of which no shape can be made, behind its file's name.
inline constexpr std::string_view without_loop =
    "gloves were recorded, but no loop that shapes a model; shape one with `nendo run --right "
    "replay:FILE`";

class LoopReplay {
public:
  /// A loop as it was when it began, over `model`, which ought to be the one that was recorded
  /// (LoopSetup::mesh_sum). Error: bad_input (gloves alone were recorded, or what tells of the loop
  /// is damaged; the hands cannot take hold of the model).
  static Result<std::unique_ptr<LoopReplay>> make(const Setup& setup, const deform::Mesh& model);

  /// What comes next in the recording. True: it was a tick, and it has run.
  bool feed(const Entry& entry) noexcept;
  /// Nothing was missing so far, so that the shape is the recorded loop's.
  bool is_exact() const noexcept { return exact_; }

  flow::DeformLoop& loop() noexcept { return *loop_; }

private:
  LoopReplay() = default;
  void take(const driver::RecordedSample& sample) noexcept;

  std::vector<std::unique_ptr<SampleRing>> rings_;
  flow::CommandRing commands_{2048};
  std::unique_ptr<flow::DeformLoop> loop_;
  bool exact_ = true;
};

} // namespace nendo::recording
