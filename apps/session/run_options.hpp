#pragma once
// The options of a run on the command line.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nendo/deform/mesh_file.hpp>
#include <nendo/flow/deform_loop.hpp>
#include <nendo/flow/realtime.hpp>

#include "gloves/open_hand.hpp"
#include "session/overdub.hpp"
#include "session/run_recording.hpp"

namespace nendo::session {

/// The file for an edited puppet.
struct PuppetPlace {
  std::string file;             ///< .toml; empty: puppets cannot be edited
  bool may_be_replaced = false; ///< it is the opened file
};

struct RunOptions {
  /// There is no model: the hands move, and shape nothing. Nothing is written at the end.
  bool hands_only = false;
  std::vector<std::string> gloves;        ///< GLOVEs, each for the hand that it is; or none
  std::string left;                       ///< GLOVE; empty: not requested
  std::string right;                      ///< GLOVE; empty: not requested
  sculpting::WristOptions wrists;         ///< the trackers of the wrists
  std::string mesh;                       ///< empty: the shipped model, or a puppet's
  deform::ReadOptions reading{};          ///< the file's axes, also for written files
  std::string puppet_file;                ///< empty: none
  std::optional<puppet::Puppet> puppet{}; ///< the contents of that file
  PuppetPlace out_puppet{};               ///< where a window saves the puppet
  std::string out;                        ///< empty: a name from date and time
  std::string picture;                    ///< empty: none
  std::string mask_file;                  ///< the file of `masks`, as given
  std::optional<puppet::Puppet> masks{};  ///< fingertips' masks, without points; nothing: none
  bool symmetric = false;                 ///< fingertips shape both sides
  /// Max vertices of automatic refinement; 0: none.
  std::uint32_t refine_to = 0;
  bool changes_topology = false; ///< refinement also separates, opens or fuses thin places
  double duration_s = 0.0;       ///< 0: until a stop signal
  /// The fingertips' radii for parse_radius(); empty: one radius, computed from the model's size.
  std::string radius;
  double model_size_m = 0.8; ///< the model's longest side, on the stage
  bool json = false;
  bool verbose = false;                   ///< the summary has numbers about folds
  std::optional<double> undo_memory_mb{}; ///< nothing: half of the machine's memory
  gloves::CalibrationOptions calibration;
  gloves::HandLength length;
  hand::FilterOptions filter; ///< the filter of both hands
  flow::LoopOptions loop;
  std::shared_ptr<Overdub> over{}; ///< the take that is played; null: none
  LivePart live{};                 ///< the angles that the gloves play; nothing: all
  RecordingOptions recording;
  flow::RealtimeOptions realtime; ///< real-time rights of the loop's thread
};

} // namespace nendo::session
