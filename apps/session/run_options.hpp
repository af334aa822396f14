#pragma once
// What a run is asked for.

#include <optional>
#include <string>
#include <vector>

#include <nendo/flow/deform_loop.hpp>
#include <nendo/flow/realtime.hpp>

#include "gloves/glove_calibration.hpp"
#include "gloves/hand_length.hpp"
#include "session/run_recording.hpp"

namespace nendo::session {

struct RunOptions {
  std::string left;        ///< GLOVE; empty: not asked for
  std::string right;       ///< GLOVE; empty: not asked for
  std::string mesh;        ///< empty: the shipped model
  std::string out;         ///< empty: a name made of date and time
  std::string picture;     ///< empty: none
  double duration_s = 0.0; ///< 0: until a stop signal
  std::string radius;      ///< as deform::parse_supports_by_point; empty: of the model's size
  bool json = false;
  std::optional<double> undo_memory_mb{}; ///< nothing: half of what there is
  gloves::CalibrationOptions calibration;
  gloves::HandLength length;
  hand::FilterOptions filter; ///< of both hands
  flow::LoopOptions loop;
  RecordingOptions recording;
  flow::RealtimeOptions realtime;  ///< of the loop's thread
  std::vector<flow::Grant> grants; ///< what was asked for before, of the process and the readers
};

} // namespace nendo::session
