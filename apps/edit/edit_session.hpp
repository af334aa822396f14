#pragma once
// What goes on behind the window of `nendo edit view`: actions become edits, and the timeline what
// there is to see. Knows no window.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nendo/timeline/edit_history.hpp>
#include <nendo/timeline/hand_curve.hpp>
#include <nendo/timeline/play_head.hpp>
#include <nendo/timeline/shape_cache.hpp>
#include <nendo/viewer/scene_frame.hpp>
#include <nendo/viewer/timeline_view.hpp>

#include "edit/glb_export.hpp"

namespace nendo::edit {

class EditSession {
public:
  /// out: where the timeline is saved, ending in .timeline.toml. The timeline can be played over
  /// the model.
  EditSession(timeline::Timeline timeline, deform::Mesh model, std::string out);

  /// Does all that a person wants; what cannot be is told in the view's message.
  void handle(const viewer::EditActions& actions);
  /// So much time has passed.
  void advance(double elapsed_s);
  /// As `select` and `seek_s` of actions.
  void select(const timeline::KeyRef& key);
  void seek(double time_s);

  /// Of all as it is now.
  const viewer::TimelineView& view();
  /// The hands at the play head, exactly, and where they took hold; without vertices.
  const viewer::SceneFrame& moment();
  /// The nearest to the play head that there is.
  timeline::ShapeCache::Found shape() const { return cache_.nearest(head_.time_s()); }
  timeline::ShapeCache::Progress progress() const { return cache_.progress(); }

  const timeline::EditHistory& history() const noexcept { return history_; }
  bool has_ended() const noexcept { return ended_; } ///< somebody quit

private:
  using Edit = timeline::EditHistory::Edit;
  void tell(std::string message);
  /// Of what was done; an error's message in place of it.
  void tell(const Result<void>& done, const std::string& message);
  void handle(viewer::EditCommand command);
  void try_out(const viewer::KeyDrag& drag);
  void try_out(const viewer::TipDrag& drag);
  void try_out(const viewer::KeyBlend& blend);
  void add_keys();
  void delete_key();
  void copy_key();
  void mirror();
  void retime(const viewer::Retiming& times);
  void save();
  void begin_export();
  void go_to_key(const std::optional<timeline::KeyRef>& key);
  void step(double frames);
  void go_back_or_forth(bool went, const char* done, const char* nothing);
  void follow_history();
  void follow_export();
  std::optional<timeline::KeyRef> key_of(const std::optional<viewer::StripKey>& key) const;
  double head_limit_s() const noexcept { return history_.timeline().duration_s; }

  deform::Mesh model_;
  std::string out_;
  std::string export_file_;
  timeline::EditHistory history_;
  timeline::ShapeCache cache_;
  timeline::PlayHead head_;
  std::unique_ptr<GlbExport> export_;
  std::vector<timeline::HandCurve> curves_; ///< by the timeline's hands
  std::optional<std::uint64_t> followed_;   ///< the history's revision of which they are
  viewer::TimelineView view_;
  viewer::SceneFrame moment_;
  bool ended_ = false;
};

} // namespace nendo::edit
