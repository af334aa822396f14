#pragma once
// The controls of a timeline: a panel beside the picture, and the play head's controls and the dope
// sheet below it. Main thread.

#include <cstdint>

#include "forms/dope_sheet_form.hpp"
#include "forms/form.hpp"
#include "forms/timeline_view.hpp"

namespace nendo::forms {

class TimelinePanel {
public:
  /// bends_fingers: the user can drag fingertips in the picture.
  explicit TimelinePanel(bool bends_fingers = false) noexcept : bends_fingers_(bends_fingers) {}

  /// Describes the file, the selected key, the puppet's functions, and changes of all of it.
  void describe(Form& form, const TimelineView& view, EditActions& actions);
  /// Describes the play head's controls and the dope sheet.
  void describe_strip(Form& form, const TimelineView& view, EditActions& actions);
  /// Adds a command that a key or a search gives. It ends the drag of a key, or with select_none
  /// gives the drag up instead.
  void add(EditCommand command, EditActions& actions);

private:
  void describe_key(Form& form, const TimelineView& view, EditActions& actions);
  void describe_whole(Form& form, const TimelineView& view, EditActions& actions);

  bool bends_fingers_;
  DopeSheetForm sheet_;
  Retiming retiming_{0.0, 0.0, 2.0};
  bool retiming_shown_ = false;
  float blend_ = 0.0F;
  bool blends_ = false; ///< the blend is tried, and not kept yet
};

} // namespace nendo::forms
