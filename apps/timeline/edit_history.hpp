#pragma once
// A timeline that is being edited, with the undo of its edits: of keys and settings in a document,
// not of shapes (deform::SculptedShape), which are played again. It has the selected key, and knows
// whether there are unsaved changes.

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>

#include <nendo/base/result.hpp>

#include "timeline/timeline.hpp"

namespace nendo::timeline {

class EditHistory {
public:
  explicit EditHistory(Timeline timeline);
  ~EditHistory();
  EditHistory(const EditHistory&) = delete;
  EditHistory& operator=(const EditHistory&) = delete;

  const Timeline& timeline() const noexcept { return timeline_; }
  /// Returns a number that changes with each change of timeline().
  std::uint64_t revision() const noexcept { return revision_; }

  /// Returns the selected key, which always exists in the timeline, or nothing if no key is
  /// selected.
  const std::optional<KeyRef>& selected() const noexcept { return selected_; }
  void select(std::optional<KeyRef> key) noexcept;

  /// An edit (edit.hpp) that returns the key to select afterwards. If it returns an error, nothing
  /// changes, and the error is passed on.
  using Edit = std::function<Result<std::optional<KeyRef>>(Timeline&)>;
  /// Does an edit as a step of its own. An edit that is being tried becomes a step first.
  Result<void> apply(const Edit& edit);
  /// Tries an edit, for example while the mouse drags a key. Each try replaces the previous one and
  /// begins with the timeline that the last step left. On an error, the previous try stays.
  Result<void> try_out(const Edit& edit);
  bool is_trying() const noexcept { return base_ != nullptr; }
  void keep(); ///< makes the tried edit a step, if it changed anything
  void drop(); ///< takes the tried edit back

  /// Undo or redo one step. The number of steps is unlimited. An edit that is being tried becomes a
  /// step first. They return false if there is no step. A new step discards the undone ones.
  bool undo();
  bool redo();
  bool can_undo() const noexcept { return done_ > 0 || is_trying(); }
  bool can_redo() const noexcept;

  /// Returns true if the timeline differs from its first state, or from its state at the last
  /// saved().
  bool is_modified() const noexcept;
  void saved();

private:
  struct Step;
  struct Base;
  void go_to(const std::optional<KeyRef>& selected) noexcept;

  Timeline timeline_;
  std::optional<KeyRef> selected_;
  std::vector<Step> steps_;
  std::size_t done_ = 0;                  ///< steps that are in timeline_; the others are undone
  std::optional<std::size_t> saved_ = 0U; ///< done_ at the last saved(), if not discarded
  std::unique_ptr<Base> base_;            ///< the state before the edit that is being tried
  std::uint64_t revision_ = 0;
};

} // namespace nendo::timeline
