#pragma once
// The timeline of the studio, which stays while other screens are shown, and asks before unsaved
// edits are lost. Main thread.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "studio/bar.hpp"
#include "studio/timeline_screen.hpp"
#include "studio/wish.hpp"

namespace nendo::studio {

/// Returns whether a file of this name is a recording or a timeline.
bool opens_in_timeline(const std::string& file);

class TimelineTab {
public:
  TimelineTab(std::shared_ptr<viewer::SceneWindow> window, Bar& bar)
      : window_(std::move(window)), bar_(bar) {}

  TimelineScreen* screen() const noexcept { return screen_.get(); } ///< null: none
  bool is_modified() const noexcept { return screen_ && screen_->is_modified(); }
  /// Replaces the screen by that of a file, or of no file yet.
  void open(const std::string& file);
  void open(const FirstTimeline& first);
  /// To be called before show(), if something else was shown before. Without a screen, opens
  /// `usual`; empty: no file yet.
  void enter(const std::string& usual = {});
  /// Draws one picture, with the bar. If it cannot be shown, the bar says why, and there is no
  /// screen any more.
  Wish show();

  /// Returns whether the wish loses no unsaved edits. Otherwise asks the user, and take_settled()
  /// returns the wish later. Asks for the file that is to be opened, if the wish has none.
  bool lets(const Wish& wish);
  /// Returns the wish that waited for the answer, once the edits are saved or discarded. To be
  /// called in each picture, before other questions take the answer.
  Wish take_settled();

private:
  bool has_edits_to_lose() const noexcept;

  std::shared_ptr<viewer::SceneWindow> window_;
  Bar& bar_;
  std::unique_ptr<TimelineScreen> screen_;
  Wish waiting_;
  std::optional<std::uint64_t> discarded_{}; ///< the revision that the user does not want to save
};

} // namespace nendo::studio
