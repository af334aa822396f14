#pragma once
// Draws a PNG of a model, or of times of a recording or a timeline, without a screen.

#include <cstdint>
#include <string>

#include <nendo/base/result.hpp>

#include "render/scene.hpp"
#include "takes/take.hpp"

namespace nendo::app::picture_command {

/// The options of `nendo picture`, as they are typed.
struct PictureOptions {
  std::string up; ///< empty: y
  std::string file;
  std::string mesh; ///< the model of a take, if it is no longer where it was
  std::string out;
  std::string view = "30,12";
  std::string size = "960x720";
  std::uint32_t turntable = 0;
  std::uint32_t strip = 0;
  std::string times;          ///< with commas; empty: the first one
  bool by_glove_time = false; ///< `times` count from the gloves' first samples
  std::uint32_t key_poses = 0;
  std::string captions;      ///< with commas; empty: none
  std::uint32_t columns = 0; ///< 0: as many as make the sheet nearly square
  bool numbered = false;
  std::string colour = "model";
  render::SceneParts parts{};
  bool no_hands = false;
};

/// Draws the picture of a take, which was read from `options.file`, and writes it. Blocks. Errors:
/// usage (an option, which the message names), those of takes::read_take(), failed (it cannot be
/// written).
Result<void> draw_picture(const PictureOptions& options, const takes::Take& take);

} // namespace nendo::app::picture_command
