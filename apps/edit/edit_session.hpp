#pragma once
// The editing session behind a window, or a page in a browser. It turns a person's actions into
// edits of the timeline, and the timeline into what these show. It knows neither of them.

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "commands/edit_command.hpp"
#include "edit/shape_pictures.hpp"
#include "forms/timeline_view.hpp"
#include "render/scene_frame.hpp"
#include "timeline/edit_history.hpp"
#include "timeline/hand_curve.hpp"
#include "timeline/play_head.hpp"
#include "timeline/shape_cache.hpp"

namespace nendo::edit {

class GlbExport;

class EditSession {
public:
  /// out: the file to which the timeline is saved; its name ends in .timeline.toml. It must be
  /// possible to play the timeline over the model.
  EditSession(timeline::Timeline timeline, deform::Mesh model, std::string out);
  ~EditSession();
  EditSession(const EditSession&) = delete;
  EditSession& operator=(const EditSession&) = delete;

  /// Does all that a person asks for, but to quit. What cannot be done is reported in the view's
  /// message.
  void handle(const forms::EditActions& actions);
  /// Moves the play head on by the time that has passed.
  void advance(double elapsed_s);
  /// These do what `select` and `seek_s` of EditActions do.
  void select(const std::optional<timeline::KeyRef>& key);
  void seek(double time_s);

  /// Returns the view of the present state. It is valid until the next call.
  const forms::TimelineView& view();
  /// Returns the exact hands at the play head. Index: flow::Placement::index_of(side).
  std::array<std::optional<puppet::HandState>, 2> hands() const;
  /// Returns these hands, and where they grabbed. The frame has no vertices.
  const render::SceneFrame& scene_frame();
  /// Returns the available shape that is nearest to the play head.
  timeline::ShapeCache::Found shape() const { return cache_.nearest(head_.time_s()); }
  timeline::ShapeCache::Progress progress() const { return cache_.progress(); }
  void hurry_pictures() noexcept { pictures_.hurry(); } ///< as ShapePictures::hurry()
  /// Returns whether the last view had all pictures that were asked for, of the latest shapes.
  bool has_all_pictures() const noexcept { return has_all_pictures_; }

  const timeline::EditHistory& history() const noexcept { return history_; }

private:
  using Edit = timeline::EditHistory::Edit;
  void report(std::string message, bool refused = false);
  /// Reports `message` if `done` is no error, or else the message of the error.
  void report(const Result<void>& done, const std::string& message);
  void handle(forms::EditCommand command);
  void execute(forms::EditCommand command);
  void try_out(const forms::KeyDrag& drag);
  void try_out(const forms::TipDrag& drag);
  void try_out(const forms::KeyBlend& blend);
  void add_keys();
  void delete_key();
  void copy_key();
  void mirror();
  void retime(const forms::Retiming& times);
  void save();
  void begin_export();
  void go_to_neighbour(bool next);
  void step(double frames);
  void step_history(bool redoes);
  void follow_history();
  void follow_functions(const timeline::CachedShape* at_head);
  void set_cells(std::vector<forms::StripPicture> cells);
  void follow_pictures();
  void follow_export();
  std::optional<timeline::KeyRef> key_of(const forms::StripKey& key) const;
  commands::EditFacts facts() const noexcept;
  double head_limit_s() const noexcept { return history_.timeline().duration_s; }

  deform::Mesh model_;
  std::string out_;
  std::string export_file_;
  timeline::EditHistory history_;
  timeline::ShapeCache cache_;
  ShapePictures pictures_;
  timeline::PlayHead head_;
  std::unique_ptr<GlbExport> export_;
  std::vector<timeline::MovingHand> hands_; ///< in the order of the timeline's hands
  std::optional<std::uint64_t> followed_;   ///< the revision of the history to which hands_ belong
  /// The computed time and the revision of the history.
  using CurvesOf = std::pair<double, std::optional<std::uint64_t>>;
  CurvesOf curves_of_{-1.0, {}}; ///< those of the curves in view_
  forms::TimelineView view_;
  render::SceneFrame scene_frame_;
  bool has_all_pictures_ = false;
};

} // namespace nendo::edit
