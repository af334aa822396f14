#pragma once
// The timeline as a screen of the studio: opened from its file, or made from a recording. Main
// thread.

#include <future>
#include <memory>
#include <optional>
#include <string>

#include "edit/window_editing.hpp"
#include "studio/wish.hpp"
#include "takes/timeline_frames.hpp"
#include "timeline/edit.hpp"

namespace nendo::studio {

/// A timeline that was read already, and what is shown of it first.
struct FirstTimeline {
  std::string file;
  std::string out; ///< where it is saved
  std::shared_ptr<takes::TimelineFrames> frames;
  std::optional<timeline::KeyRef> key{}; ///< selected
  std::optional<double> at_s{};          ///< position of the play head
};

class TimelineScreen {
public:
  /// Begins to read a timeline or a recording in a thread of its own. A recording is replayed for
  /// it, which takes a small part of its duration. Without a file, the screen says how to get one.
  TimelineScreen(std::shared_ptr<viewer::SceneWindow> window, std::string file);
  TimelineScreen(std::shared_ptr<viewer::SceneWindow> window, const FirstTimeline& first);

  /// Draws one picture. Returns Quit when the user closes the window. Error: the file cannot be
  /// read or played.
  Result<Wish> show();
  /// Shows its model again, after something else was shown in the window.
  void show_again();

  const std::string& file() const noexcept { return file_; }
  const std::string& out() const noexcept { return out_; } ///< where it is saved
  bool is_modified() const noexcept;
  std::uint64_t revision() const noexcept; ///< another after each edit, undo and redo
  /// Saves the edits. A failure is shown as a message, and is_modified() stays true.
  void save();
  /// Returns the editing; null: the file is still being read, or there is none.
  edit::WindowEditing* editing() noexcept { return editing_.get(); }

private:
  Wish show_reading();

  std::shared_ptr<viewer::SceneWindow> window_;
  std::string file_; ///< empty: none
  std::string out_;  ///< where the timeline is saved
  std::future<Result<std::unique_ptr<takes::TimelineFrames>>> reading_;
  std::unique_ptr<edit::WindowEditing> editing_;
};

} // namespace nendo::studio
