#pragma once
// An observer watches a run from the main thread and may send commands: the keys, a window, a
// browser.

#include <memory>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <nendo/flow/command.hpp>
#include <nendo/flow/frame.hpp>
#include <nendo/flow/model_version.hpp>

#include "commands/commands.hpp"
#include "gloves/device_status.hpp"
#include "session/place_loop.hpp"
#include "session/report.hpp"
#include "viewer/picture_times.hpp"

namespace nendo::session {

class RunSaving;

struct RunStatus {
  const flow::Frame& frame;        ///< the latest
  const flow::ModelVersion& model; ///< the model of that frame
  bool fresh = false;              ///< the frame is new since the last call
  const gloves::DeviceStatuses& devices;
  commands::RunFacts facts{};
  /// The frame's puppet; null: none.
  const std::shared_ptr<const puppet::Rig>& puppet;
  RunSaving* saving = nullptr; ///< not null in a run
  std::string_view recorded{}; ///< the file of the last complete recording; empty: none

  commands::Situation situation() const noexcept { return {frame, facts}; }
};

/// Saves the shape into this file, also if it exists; later saves without a name go there too.
struct SaveShapeAs {
  std::string file; ///< .obj, .ply or .stl
};

/// An observer's request: a command, or a new puppet, not null, for the loop.
using Ask = std::variant<flow::Command, std::shared_ptr<const puppet::Rig>, SaveShapeAs>;
using Asks = std::vector<Ask>;

/// All calls come from the main thread. No call may block for longer than 30 ms.
class Observer {
public:
  virtual ~Observer() = default;
  /// Called before the loop begins. `start` is valid until the run ends.
  virtual void loop_begins(const LoopStart& start) { static_cast<void>(start); }
  /// Called repeatedly while the loop runs. Appends the requests since the last call.
  virtual void update(const RunStatus& status, Asks& asks) = 0;
  /// Shows a message about a command to the user.
  virtual void report(const Report& message) { static_cast<void>(message); }
  /// Returns whether update() waits by itself, as a window does for its screen.
  virtual bool sets_pace() const noexcept { return false; }
  /// Returns whether the run continues after all gloves have ended (Glove::has_ended()), until the
  /// user ends it, as with a window.
  virtual bool stays_open() const noexcept { return false; }
  /// Returns whether the user has decided about the shape, which the run then does not write at
  /// its end.
  virtual bool has_settled_shape() const noexcept { return false; }
  /// Returns the times of the pictures that it has drawn; null: it draws none.
  virtual const viewer::PictureTimes* picture_times() const noexcept { return nullptr; }
  /// Called after the loop has ended and the shape is written. The run returns its error.
  virtual Result<void> end() { return {}; }
};

} // namespace nendo::session
