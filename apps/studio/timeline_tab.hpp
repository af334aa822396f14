#pragma once
// The timeline in the studio's window. Main thread.

#include <memory>
#include <string>
#include <utility>

#include "edit/window_editing.hpp"
#include "studio/bar.hpp"
#include "studio/studio_timeline.hpp"
#include "studio/wish.hpp"

namespace nendo::studio {

class TimelineTab {
public:
  TimelineTab(std::shared_ptr<viewer::SceneWindow> window, Bar& bar)
      : window_(std::move(window)), bar_(bar) {}

  void open(const std::string& file); ///< as StudioTimeline
  void open(const FirstTimeline& first);
  bool is_open() const noexcept { return timeline_.is_open(); }
  bool is_modified() const noexcept { return timeline_.is_modified(); }
  bool is_in_use() const { return timeline_.is_in_use(); }
  bool has_edits_to_lose() const noexcept { return timeline_.has_edits_to_lose(); }
  edit::EditSession* session() const noexcept { return timeline_.session(); } ///< may be null
  /// Returns whether the last picture was final.
  bool is_settled() const noexcept { return editing_ && editing_->is_settled(); }

  /// To be called before show(), if something else was shown before. If nothing is open, opens
  /// `usual`; empty: no file yet.
  void enter(const std::string& usual = {});
  /// Draws one picture, with the bar. Returns Quit when the user closes the window. What cannot be
  /// read or played is open no more. Errors: those of StudioTimeline::read() and
  /// edit::WindowEditing::show().
  Result<Wish> show();

  /// Returns whether the wish loses no unsaved edits. Otherwise asks the user, and take_settled()
  /// returns the wish later. Asks for the file that is to be opened, if the wish has none.
  bool lets(const Wish& wish);
  /// Returns the wish that waited for the answer, once the edits are saved or discarded. To be
  /// called in each picture, before other questions take the answer.
  Wish take_settled();

private:
  Wish show_waiting_words();

  std::shared_ptr<viewer::SceneWindow> window_;
  Bar& bar_;
  StudioTimeline timeline_;
  std::unique_ptr<edit::WindowEditing> editing_; ///< null: no session yet
};

} // namespace nendo::studio
