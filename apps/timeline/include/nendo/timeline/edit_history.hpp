#pragma once
// A timeline while somebody edits it: which key is selected, what can be undone and redone, and
// whether it is as it was saved.

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>

#include <nendo/base/result.hpp>
#include <nendo/timeline/key_search.hpp>

namespace nendo::timeline {

class EditHistory {
public:
  explicit EditHistory(Timeline timeline);
  ~EditHistory();
  EditHistory(EditHistory&&) noexcept;
  EditHistory& operator=(EditHistory&&) noexcept;

  const Timeline& timeline() const noexcept { return timeline_; }
  /// Another one after each change of timeline().
  std::uint64_t revision() const noexcept { return revision_; }

  /// The selected key; never one that does not exist.
  const std::optional<KeyRef>& selected() const noexcept { return selected_; }
  void select(std::optional<KeyRef> key) noexcept;

  /// Does what edit.hpp has, and gives which key is to be selected then. What it refuses changes
  /// nothing, and its error is passed on.
  using Edit = std::function<Result<std::optional<KeyRef>>(Timeline&)>;
  /// A step of its own. What was being tried becomes one first.
  Result<void> apply(const Edit& edit);
  /// What a mouse does while it drags: each try begins at the timeline as the last step left it, in
  /// place of the try before. Refused: the try before stays.
  Result<void> try_out(const Edit& edit);
  bool is_trying() const noexcept { return base_ != nullptr; }
  void keep(); ///< what was tried becomes a step, if it changed anything
  void drop(); ///< or it does not

  /// As many steps as there were; what is being tried becomes one first. False: there is
  /// no step. A new step forgets what was undone.
  bool undo();
  bool redo();
  bool can_undo() const noexcept { return done_ > 0 || is_trying(); }
  bool can_redo() const noexcept;

  /// The timeline is not as it was at first, or at the last saved().
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
  std::optional<std::size_t> saved_ = 0U; ///< how many were when it was saved; may be forgotten
  std::unique_ptr<Base> base_;            ///< of what is being tried
  std::uint64_t revision_ = 0;
};

} // namespace nendo::timeline
