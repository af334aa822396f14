#include "studio/page_dialogs.hpp"

#include <utility>

namespace nendo::studio {

namespace {

/// Takes the keys of the timeline editor, which may be behind the dialog.
void begin_dialog(web::PageForm& form) {
  form.part("dialog");
  form.take_edit_command();
}

} // namespace

bool show_message(web::PageForm& form, const std::string& message, Form::Tone tone) {
  begin_dialog(form);
  form.text(message, tone);
  return form.button("Close", "");
}

std::optional<Answer> ask_to_save(web::PageForm& form, const std::string& what) {
  begin_dialog(form);
  form.text("Save " + what + "?");
  form.lines_of(3);
  std::optional<Answer> answer;
  if (form.button("Save", "", Form::Look::chosen)) answer = Answer::save;
  if (form.button("Discard", "")) answer = Answer::discard;
  if (form.button("Stay", "")) answer = Answer::stay;
  return answer;
}

std::optional<Answer> ask_to_discard(web::PageForm& form, const std::string& what) {
  begin_dialog(form);
  form.text("Discard " + what + "?");
  form.lines_of(2);
  std::optional<Answer> answer;
  if (form.button("Discard", "")) answer = Answer::discard;
  if (form.button("Stay", "", Form::Look::chosen)) answer = Answer::stay;
  return answer;
}

Wish OpenDialog::describe(web::PageForm& form) {
  Wish wish;
  begin_dialog(form);
  form.title("Open a file", "");
  form.line("file name", file_);
  form.lines_of(2);
  const auto look = file_.empty() ? Form::Look::grey : Form::Look::chosen;
  if (form.button("Open", "A file on the machine of the gloves.", look)) wish = Open{file_};
  if (is_wish(wish) || form.button("Cancel", "")) close();
  form.file("Choose a file of this device", "It is copied to the machine of the gloves.");
  return wish;
}

} // namespace nendo::studio
