#pragma once
// A run of the studio on a page: the tabs over it, the timeline beside it, and a question before a
// changed shape is lost. Main thread.

#include <chrono>
#include <cstdint>
#include <string>
#include <utility>

#include "session/observer.hpp"
#include "studio/page_dialogs.hpp"
#include "studio/page_timeline.hpp"
#include "studio/wish.hpp"
#include "web/page_form.hpp"
#include "web/server.hpp"

namespace nendo::studio {

/// Between descriptions of a screen.
inline constexpr std::chrono::milliseconds picture_time(33);

/// Describes the tabs, and the name of the file. Returns what was clicked.
Wish describe_bar(web::PageForm& form, Screen now, const std::string& file);

class PageRun final : public session::Observer {
public:
  /// `file` is the model's name. `asks_to_save`: leaving asks whether the shape is saved, and a run
  /// that is left does not write it. `server` and `timeline` must outlive this.
  PageRun(web::Server& server, PageTimeline& timeline, std::string file, bool asks_to_save)
      : server_(server), timeline_(timeline), file_(std::move(file)), asks_to_save_(asks_to_save) {}
  /// Leaves the timeline. Removes a file that was sent, if the user has not decided about it.
  ~PageRun() override;
  PageRun(const PageRun&) = delete;
  PageRun& operator=(const PageRun&) = delete;

  void update(const session::RunStatus& status, session::Asks& asks) override;
  void report(const session::Report& message) override;
  bool stays_open() const noexcept override { return true; }
  bool has_settled_shape() const noexcept override { return is_settled_; }

  /// Returns where the user went when the run was left; nothing to wish: it ended by itself.
  const Wish& left_for() const noexcept { return left_for_; }

private:
  void follow_recording(const session::RunStatus& status);
  void follow_saving(const session::RunStatus& status, session::Asks& asks);
  void open_sent(const session::RunStatus& status, session::Asks& asks);
  void notify(const std::string& message, Form::Tone tone = Form::Tone::warning);
  void show_dialog(const session::RunStatus& status, session::Asks& asks);
  void show_timeline(const session::RunStatus& status, session::Asks& asks);
  void ask(session::Asks& asks);
  void go(const Wish& wish, const session::RunStatus& status, session::Asks& asks);
  void go_to(Screen screen, const session::RunStatus& status, session::Asks& asks);
  void leave(session::Asks& asks);

  web::Server& server_;
  PageTimeline& timeline_;
  web::PageForm form_;
  OpenDialog dialog_;
  std::string message_; ///< shown over the timeline until it is closed
  Form::Tone tone_ = Form::Tone::warning;
  std::string file_;
  bool asks_to_save_;
  HostTime next_{}; ///< when the next picture is due
  bool is_settled_ = false;
  Wish waiting_; ///< where the user goes once it is settled what becomes of the shape
  Wish left_for_;
  bool saves_first_ = false;
  bool records_ = false;    ///< a recording is active
  bool has_chosen_ = false; ///< the user has opened a file since the last recording began
  std::string recorded_;    ///< the file of the last recording
  bool shows_timeline_ = false;
  bool held_ = false;       ///< the hands held the model before the timeline was shown
  std::uint32_t saves_ = 0; ///< the number of saves of the run so far
};

} // namespace nendo::studio
