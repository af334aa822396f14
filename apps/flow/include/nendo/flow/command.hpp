#pragma once
// Everything that a person may ask of a run, whichever way it comes: a key, the window's mouse and
// buttons, or a browser. A command is a plain value of fixed size, so that it passes through rings
// without allocation.

#include <type_traits>
#include <variant>

#include <nendo/base/spsc_ring.hpp>
#include <nendo/flow/loop_settings.hpp>
#include <nendo/flow/request.hpp>
#include <nendo/flow/wrist_move.hpp>

namespace nendo::flow {

/// The loop goes on with these settings.
struct ChangeSettings {
  LoopSettings settings;
  friend bool operator==(const ChangeSettings&, const ChangeSettings&) = default;
};
/// The model becomes again what was loaded from its file.
struct ResetModel {
  friend bool operator==(const ResetModel&, const ResetModel&) = default;
};
/// Recording to a file begins or ends.
struct SetRecording {
  bool on = false;
  friend bool operator==(const SetRecording&, const SetRecording&) = default;
};
/// The shape as it is now is written to a file of its own.
struct SaveShape {
  friend bool operator==(const SaveShape&, const SaveShape&) = default;
};
/// The input of the last while is written to a file, if the run keeps it in memory.
struct SaveRecording {
  friend bool operator==(const SaveRecording&, const SaveRecording&) = default;
};
/// The run ends, and its shape is written.
struct EndRun {
  friend bool operator==(const EndRun&, const EndRun&) = default;
};

/// A loop does what Request and WristMove say, at the beginning of its next tick, and passes over
/// all others, which are done by whoever runs the loop.
using Command = std::variant<Request, WristMove, ChangeSettings, ResetModel, SetRecording,
                             SaveShape, SaveRecording, EndRun>;
static_assert(std::is_trivially_copyable_v<Command>);

/// One thread pushes, one thread takes.
using CommandRing = SpscRing<Command>;

/// Whether a loop does it by itself while it runs.
constexpr bool is_for_loop(const Command& command) noexcept {
  return std::holds_alternative<Request>(command) || std::holds_alternative<WristMove>(command);
}

} // namespace nendo::flow
