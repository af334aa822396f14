#pragma once
// The bar at the top of the studio's window: files, and a tab for each screen; and its dialogs.
// Main thread.

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "studio/file_dialog.hpp"
#include "studio/wish.hpp"
#include "viewer/scene_window.hpp"

namespace nendo::studio {

/// What the bar shows.
struct BarState {
  Screen now = Screen::start;
  std::string file{}; ///< the model that is shaped, or the timeline; empty: none
  bool is_modified = false;
  bool is_shaping = false; ///< a run has a shape, which can be saved
};

class Bar {
public:
  /// Draws itself in each picture of the window, until it is destroyed.
  explicit Bar(viewer::SceneWindow& window);
  ~Bar();
  Bar(const Bar&) = delete;
  Bar& operator=(const Bar&) = delete;

  void set(BarState state) { state_ = std::move(state); }

  // Each returns what was asked for since the last call:

  /// Another screen, a file, or the end. A file that was dropped on the window counts as opened.
  Wish take_wish();
  /// The file into which the shape is to be saved; empty: the usual one.
  std::optional<std::string> take_save() { return std::exchange(save_, std::nullopt); }
  std::optional<Answer> take_answer() { return std::exchange(answer_, std::nullopt); }

  /// Asks in a dialog whether unsaved changes are saved. `what` is "the shape" or a file.
  void ask(const std::string& what);
  /// Asks whether `what`, which cannot be saved, is discarded.
  void ask_to_discard(const std::string& what);
  /// Opens the dialog that saves the shape; take_save() has the result.
  void ask_where_to_save();
  /// Opens the dialog that opens a file.
  void ask_what_to_open();
  /// Shows a message about something that failed, until the user closes it.
  void show_error(const std::string& message) { error_ = message; }
  /// Returns whether a dialog is open.
  bool has_dialog() const noexcept { return dialog_.is_open() || question_; }

private:
  void draw();
  void draw_file_menu();
  void draw_tabs();
  void draw_question();
  void draw_error();
  void follow_keys();

  viewer::SceneWindow& window_;
  BarState state_;
  FileDialog dialog_;
  struct Question {
    std::string words;
    bool offers_to_save = true;
  };
  std::optional<Question> question_;
  std::string error_;
  std::vector<std::string> recent_; ///< the files of the menu, since it was opened
  Wish wish_;
  std::optional<std::string> save_;
  std::optional<Answer> answer_;
};

} // namespace nendo::studio
