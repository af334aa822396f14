#pragma once
// The dialogs of the page: a message, a question before something is lost, and the name of a file.
// Each takes the keys of the timeline editor, so describe it before the timeline. Main thread.

#include <optional>
#include <string>

#include "studio/wish.hpp"
#include "web/page_form.hpp"

namespace nendo::studio {

using forms::Form;

/// Describes a dialog with a message. Returns whether it was closed.
bool show_message(web::PageForm& form, const std::string& message,
                  Form::Tone tone = Form::Tone::warning);
/// Describes a dialog that asks whether `what` is saved. Returns what was clicked.
std::optional<Answer> ask_to_save(web::PageForm& form, const std::string& what);
/// Does the same for what can only be discarded.
std::optional<Answer> ask_to_discard(web::PageForm& form, const std::string& what);

/// A dialog in which the user types a file's name, or chooses a file of the own device.
class OpenDialog {
public:
  void open() noexcept { is_open_ = true; }
  void close() noexcept { is_open_ = false; }
  bool is_open() const noexcept { return is_open_; }
  /// Returns the file that was typed. The server has one that was chosen.
  Wish describe(web::PageForm& form);

private:
  bool is_open_ = false;
  std::string file_; ///< the name that is typed
};

} // namespace nendo::studio
