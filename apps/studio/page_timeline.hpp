#pragma once
// The timeline on the studio's page, beside a run or without one. Main thread.

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include <nendo/flow/frame.hpp>

#include "forms/timeline_panel.hpp"
#include "studio/studio_timeline.hpp"
#include "studio/wish.hpp"
#include "web/model_message.hpp"
#include "web/page_form.hpp"
#include "web/server.hpp"

namespace nendo::studio {

/// Index: flow::Placement::index_of(side).
using HandSizes = std::array<hand::HandSize, 2>;

class PageTimeline {
public:
  /// Of a model with more than `most` vertices nothing is shown.
  explicit PageTimeline(web::Server& server, std::size_t most = web::max_vertices)
      : server_(server), most_(most) {}
  ~PageTimeline() { leave(); }
  PageTimeline(const PageTimeline&) = delete;
  PageTimeline& operator=(const PageTimeline&) = delete;

  void open(const Open& wanted); ///< as StudioTimeline
  bool is_open() const noexcept { return timeline_.is_open(); }
  bool is_modified() const noexcept { return timeline_.is_modified(); }
  bool has_edits_to_lose() const noexcept { return timeline_.has_edits_to_lose(); }
  edit::EditSession* session() const noexcept { return timeline_.session(); } ///< may be null
  bool is_in_use() const { return timeline_.is_in_use(); }
  const std::string& out() const noexcept { return timeline_.out(); }
  /// Returns the file's name for the bar; empty: none.
  std::string title() const;

  /// Shows a picture: describes the controls, does what the user asks for, and sends the shape and
  /// the hands at the play head. Returns what was clicked. What cannot be read or played is open no
  /// more. Errors: those of StudioTimeline::read() and session::check_for_browsers(), and if the
  /// shapes cannot be made.
  Result<Wish> update(web::PageForm& form);
  /// To be called before something else is shown, which the page then shows. The file stays open.
  void leave();

  bool lets(const Wish& wish) { return timeline_.lets(wish); } ///< as StudioTimeline
  bool is_asking() const noexcept { return timeline_.is_asking(); }
  /// Describes the question about unsaved edits, while is_asking(). Returns the wish that waited,
  /// once they are saved or discarded. Error: that of StudioTimeline::settle().
  Result<Wish> ask(web::PageForm& form);

private:
  Wish describe_waiting(web::PageForm& form) const;
  void edit(web::PageForm& form, edit::EditSession& session);
  Result<void> show(edit::EditSession& session);
  Result<void> present(const edit::EditSession& session,
                       std::shared_ptr<const flow::ModelVersion> model);

  web::Server& server_;
  std::size_t most_;
  StudioTimeline timeline_;
  forms::TimelinePanel panel_;
  std::optional<HostTime> updated_;
  // While the page shows it:
  std::shared_ptr<web::FrameStream> stream_; ///< null: something else is shown
  std::shared_ptr<const flow::ModelVersion> model_;
  HandSizes sizes_;
  std::shared_ptr<const timeline::CachedShape> shape_; ///< the last one that was sent
  flow::Frame frame_;
};

} // namespace nendo::studio
