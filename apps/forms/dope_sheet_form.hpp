#pragma once
// The dope sheet: pictures of the shape, and play head, keys and marks, which the pointer can move.

#include <optional>

#include "forms/form.hpp"
#include "forms/timeline_view.hpp"

namespace nendo::forms {

class DopeSheetForm {
public:
  /// Describes the sheet, and follows the pointer in it. shaded: times to highlight.
  void describe(Form& form, const TimelineView& view, const std::optional<Retiming>& shaded,
                EditActions& actions);
  /// Gives up the drag of a key. Returns whether there was one.
  bool give_up(EditActions& actions);
  /// Ends a drag as a release of the pointer does.
  void end_drag(EditActions& actions);

private:
  struct Taken {
    StripKey key;
    double pressed_x = 0.0;
    bool moved = false;
  };
  void follow(const Pointer& before, const TimelineView& view, EditActions& actions);
  void press(const TimelineView& view, const Eigen::Vector2d& at, EditActions& actions);
  void drag(const TimelineView& view, double x, bool copies, EditActions& actions);

  DopeSheet strip_;
  Pointer pointer_;            ///< in the last picture
  std::optional<Taken> taken_; ///< a key that the pointer holds
  bool scrubs_ = false;
  double head_s_ = 0.0; ///< the play head at the last picture
};

} // namespace nendo::forms
