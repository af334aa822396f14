#pragma once
// A run in the studio's window: shaping, and beside it the timeline of its recordings.

#include <memory>
#include <optional>
#include <string>

#include "session/views.hpp"
#include "studio/bar.hpp"
#include "studio/timeline_tab.hpp"
#include "studio/wish.hpp"

namespace nendo::studio {

class StudioView final : public session::Observer {
public:
  struct Parts {
    Bar& bar;
    TimelineTab& timeline;
    std::unique_ptr<session::WindowView> shaping;
  };
  /// `file` is the model's name in the bar. `asks_to_save`: leaving asks where the shape goes,
  /// and a run that is left does not write it. Otherwise the run writes it, as from a terminal.
  StudioView(Parts parts, std::string file, bool asks_to_save);
  ~StudioView() override;

  void loop_begins(const session::LoopStart& start) override;
  void update(const session::RunStatus& status, session::Asks& asks) override;
  void report(const session::Report& message) override;
  bool sets_pace() const noexcept override { return true; }
  bool stays_open() const noexcept override { return true; }
  bool has_settled_shape() const noexcept override { return is_settled_; }
  const viewer::PictureTimes* picture_times() const noexcept override {
    return parts_.shaping->picture_times();
  }
  Result<void> end() override { return parts_.shaping->end(); }

  /// Returns where the user went when the run was left; nothing to wish: it ended by itself.
  const Wish& left_for() const noexcept { return left_for_; }

private:
  void show_shaping(const session::RunStatus& status, session::Asks& asks);
  void show_timeline(const session::RunStatus& status, session::Asks& asks);
  void follow_recording(const session::RunStatus& status);
  void follow_saving(const session::RunStatus& status, session::Asks& asks);
  void go(const Wish& wish, const session::RunStatus& status, session::Asks& asks);
  void go_to(Screen screen, const session::RunStatus& status, session::Asks& asks);
  void leave(const Wish& wish, session::Asks& asks);
  Screen screen() const noexcept; ///< shaping or puppet
  TimelineTab& timeline() noexcept { return parts_.timeline; }

  Parts parts_;
  std::string file_;
  bool asks_to_save_;
  bool is_settled_ = false;
  Wish left_for_;
  Wish waiting_; ///< where the user goes once it is settled what becomes of the shape
  /// The shape is saved before: the dialog is open, or the run saves it, or has tried to.
  enum class Saving : std::uint8_t { none, asked, begun, tried } saving_ = Saving::none;
  std::uint32_t saves_ = 0; ///< the number of saves of the run so far
  bool records_ = false;    ///< a recording is active
  bool has_chosen_ = false; ///< the user has opened a file since the last recording began
  std::string recorded_;
  bool shows_timeline_ = false;
  bool held_ = false; ///< the hands held the model before the timeline was shown
};

} // namespace nendo::studio
