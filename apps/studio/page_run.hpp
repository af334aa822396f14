#pragma once
// A run of the studio on a page: the tabs over it, a replay of its recording, and a question
// before a changed shape is lost. Main thread.

#include <cstdint>
#include <memory>
#include <string>

#include "session/observer.hpp"
#include "studio/page_replay.hpp"
#include "studio/wish.hpp"
#include "web/page_form.hpp"
#include "web/server.hpp"

namespace nendo::studio {

using forms::Form;

/// Describes the tabs, and the name of the file. Returns what was clicked.
Wish describe_bar(web::PageForm& form, Screen now, const std::string& file);

/// Removes the file of a wish that is not followed, if a browser sent it.
void remove_sent(const Wish& wish);

class PageRun final : public session::Observer {
public:
  /// `file` is the model's name. `asks_to_save`: leaving asks whether the shape is saved, and a run
  /// that is left does not write it.
  PageRun(web::Server& server, LeftReadings& left, std::string file, bool asks_to_save)
      : server_(server), left_readings_(left), file_(std::move(file)), asks_to_save_(asks_to_save) {
  }
  ~PageRun() override; ///< removes a file that was sent, if the user has not decided about it
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
  void go_to(Screen screen, const session::RunStatus& status, session::Asks& asks);
  void show_replay(const session::RunStatus& status, session::Asks& asks);
  void go(const Wish& wish, const session::RunStatus& status, session::Asks& asks);
  void ask(session::Asks& asks);
  void leave(session::Asks& asks);

  web::Server& server_;
  LeftReadings& left_readings_;
  web::PageForm form_;
  std::string file_;
  bool asks_to_save_;
  bool is_settled_ = false;
  Wish waiting_; ///< where the user goes once it is settled what becomes of the shape
  Wish left_for_;
  bool saves_first_ = false;
  std::string recorded_; ///< the file of the last recording
  std::unique_ptr<PageReplay> replay_;
  bool held_ = false;       ///< the hands held the model before the replay was shown
  std::uint32_t saves_ = 0; ///< the number of saves of the run so far
};

} // namespace nendo::studio
