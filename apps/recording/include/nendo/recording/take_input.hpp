#pragma once
// All input of a recording in memory, for a run that plays it once more with other hands over it.

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <vector>

#include <nendo/flow/input_script.hpp>
#include <nendo/recording/take_reader.hpp>

namespace nendo::recording {

struct TakeInput {
  Setup setup;
  /// What the loop took: all samples, and of the commands all but those that the next loop makes
  /// itself (HoldStill, and a ChangeModel to a version that was there).
  std::unique_ptr<flow::InputScript> script;
  /// The puppets to which it changes (flow::ChangePuppet), by their numbers. One that is not here
  /// is that with which the recording began.
  std::map<std::uint32_t, std::shared_ptr<const RecordedPuppet>> puppets{};
  std::vector<driver::RecordCounts> sent; ///< one per glove
  bool is_exact = true;                   ///< nothing is missing
};

/// Reads a recording of a loop. Blocks, and takes 160 bytes for each sample. Errors: bad_input (as
/// from TakeReader::open(); or no loop was recorded, or it has no tick).
NENDO_API Result<TakeInput> read_take_input(const std::filesystem::path& path);

} // namespace nendo::recording
