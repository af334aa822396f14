#pragma once
// The timeline of the studio: opened from its file, or made from a recording. It stays while other
// screens are shown, and asks before unsaved edits are lost. Main thread.

#include <cstdint>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "edit/window_editing.hpp"
#include "studio/bar.hpp"
#include "studio/opened_files.hpp"
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

class TimelineTab {
public:
  TimelineTab(std::shared_ptr<viewer::SceneWindow> window, Bar& bar)
      : window_(std::move(window)), bar_(bar) {}

  /// Begins to read a timeline or a recording in a thread of its own. A recording is replayed for
  /// it, which takes a small part of its duration. Without a file, the screen says how to get one.
  void open(const std::string& file);
  void open(const FirstTimeline& first);
  bool is_open() const noexcept { return opened_.has_value(); }
  /// Returns the editing; null: the file is still being read, or there is none.
  edit::WindowEditing* editing() const noexcept {
    return opened_ ? opened_->editing.get() : nullptr;
  }
  bool is_modified() const noexcept;

  /// To be called before show(), if something else was shown before. If nothing is open, opens
  /// `usual`; empty: no file yet.
  void enter(const std::string& usual = {});
  /// Draws one picture, with the bar. Returns Quit when the user closes the window. What cannot be
  /// read or played is open no more, and the bar says why.
  Wish show();

  /// Returns whether the wish loses no unsaved edits. Otherwise asks the user, and take_settled()
  /// returns the wish later. Asks for the file that is to be opened, if the wish has none.
  bool lets(const Wish& wish);
  /// Returns the wish that waited for the answer, once the edits are saved or discarded. To be
  /// called in each picture, before other questions take the answer.
  Wish take_settled();

private:
  struct Opened {
    std::string file; ///< empty: none
    std::string out;  ///< where the timeline is saved
    std::future<Result<std::unique_ptr<takes::TimelineFrames>>> reading{};
    std::unique_ptr<edit::WindowEditing> editing{};
    std::optional<std::uint64_t> discarded{}; ///< the revision that the user does not want to save
  };
  Wish show_reading();
  Result<Wish> show_opened();
  bool has_edits_to_lose() const noexcept;

  std::shared_ptr<viewer::SceneWindow> window_;
  Bar& bar_;
  std::optional<Opened> opened_;
  Wish waiting_;
};

} // namespace nendo::studio
