#include "studio/studio.hpp"

#ifdef NENDO_WINDOW

#include <filesystem>
#include <string_view>
#include <utility>

#include "cli/cli.hpp"
#include "cli/model_files.hpp"
#include "studio/bar.hpp"
#include "studio/start_screen.hpp"
#include "studio/studio_flow.hpp"
#include "studio/studio_view.hpp"
#include "studio/timeline_tab.hpp"
#include "studio/window_calibration.hpp"

namespace nendo::studio {
namespace {

class WindowStudio final : public StudioFlow {
public:
  WindowStudio(std::shared_ptr<viewer::SceneWindow> window, StudioOptions options)
      : StudioFlow(std::move(options)), window_(std::move(window)), bar_(*window_),
        timeline_(window_, bar_) {
    if (!options_.timeline) return;
    timeline_.open(*options_.timeline);
    screen_ = Screen::timeline;
  }

  std::optional<Shape> choose() override {
    while (!is_over_ && !next_) {
      show_one(); // once, whatever comes: there is a last picture
      if (cli::stop_requested()) break;
    }
    // Before its pictures go.
    if (!options_.view.screenshot.empty() && !next_) last_picture_ = window_->screenshot();
    start_.reset(); // closes its gloves, which the run opens
    calibration_.reset();
    return take_next();
  }

  session::Observer* observe(const session::RunOptions& run, bool asks_to_save) override {
    view_ = std::make_unique<StudioView>(
        StudioView::Parts{bar_, timeline_, session::live_view(options_.view, run, window_)},
        cli::short_name(run.mesh), asks_to_save);
    return view_.get();
  }

  void show_error(const std::string& message) override {
    next_.reset();
    bar_.show_error(message);
  }

  Result<void> end() override {
    if (!last_picture_) return {}; // a run writes its own
    return write_png(options_.view.screenshot, *last_picture_);
  }

private:
  void show_one() {
    follow_safely(screen_ == Screen::timeline ? show_timeline()
                  : calibration_              ? show_calibration()
                                              : show_start());
    follow_safely(bar_.take_wish());
    follow_safely(timeline_.take_settled());
    if (calibration_) follow(calibration_->take_settled());
    if (window_->take_close_request()) follow_safely(Quit{});
    if (is_complete()) ++shown_;
    if (options_.view.frames > 0 && shown_ >= options_.view.frames) is_over_ = true;
  }

  /// Only pictures on which nothing is missing count.
  bool is_complete() {
    if (screen_ == Screen::timeline) {
      edit::EditSession* const session = timeline_.session();
      if (session != nullptr && options_.view.frames > 0) session->hurry_pictures();
      return timeline_.is_settled();
    }
    return start_ && start_->is_complete();
  }

  Wish show_start() {
    bar_.set({Screen::start});
    if (!start_)
      start_ = std::make_unique<StartScreen>(*window_,
                                             StartOptions{options_.gloves, options_.calibration});
    return start_->show(*window_);
  }

  Wish show_timeline() {
    const auto wish = timeline_.show();
    if (wish) return *wish;
    bar_.show_error(wish.error().message);
    screen_ = Screen::start;
    return {};
  }

  Wish show_calibration() {
    bar_.set({Screen::calibration});
    const auto wish = calibration_->show(*window_);
    if (!wish) bar_.show_error(wish.error().message);
    if (wish && !is_wish(*wish)) return {};
    learns_for_ = calibration_->learns_for();
    calibration_.reset();
    return Go{Screen::start};
  }

  /// Asks before edits of the timeline, or poses of a calibration, are lost.
  void follow_safely(const Wish& wish) {
    if (timeline_.lets(wish) && (!calibration_ || calibration_->lets(wish))) follow(wish);
  }

  Wish left_for() const override { return view_ ? view_->left_for() : Wish{}; }
  bool has_edits_to_lose() const override { return timeline_.has_edits_to_lose(); }
  NamedGlove found_glove() const override { return start_ ? start_->found_glove() : NamedGlove{}; }
  void open(const Open& wanted) override { begin_with(wanted.file); }

  void leave_screen() override {
    start_.reset();
    calibration_.reset();
    screen_ = Screen::start;
  }

  void enter_timeline(const std::string& file) override {
    if (!file.empty()) timeline_.open(file);
    timeline_.enter();
    leave_screen();
    screen_ = Screen::timeline;
  }

  void enter_calibration(const NamedGlove& glove) override {
    screen_ = Screen::calibration;
    calibration_ = std::make_unique<WindowCalibration>(*window_, bar_, glove);
  }

  std::shared_ptr<viewer::SceneWindow> window_;
  Bar bar_;
  std::unique_ptr<StartScreen> start_;
  TimelineTab timeline_;
  std::unique_ptr<WindowCalibration> calibration_;
  std::unique_ptr<StudioView> view_;
  Screen screen_ = Screen::start;
  std::optional<render::Image> last_picture_;
  std::uint32_t shown_ = 0;
};

} // namespace

Result<std::unique_ptr<Studio>> open_studio(const StudioOptions& options) {
  const auto window = session::open_window(options.view);
  if (!window) return window.error();
  return std::unique_ptr<Studio>(std::make_unique<WindowStudio>(*window, options));
}

} // namespace nendo::studio

#else

namespace nendo::studio {

Result<std::unique_ptr<Studio>> open_studio(const StudioOptions& options) {
  return session::open_window(options.view).error();
}

} // namespace nendo::studio

#endif
