#include "studio/studio.hpp"

#ifdef NENDO_WINDOW

#include <filesystem>
#include <string_view>
#include <utility>

#include "cli/cli.hpp"
#include "cli/model_files.hpp"
#include "session/kept_state.hpp"
#include "studio/bar.hpp"
#include "studio/start_screen.hpp"
#include "studio/studio_view.hpp"
#include "studio/timeline_tab.hpp"
#include "studio/window_calibration.hpp"

namespace nendo::studio {
namespace {

class WindowStudio final : public Studio {
public:
  WindowStudio(std::shared_ptr<viewer::SceneWindow> window, StudioOptions options)
      : window_(std::move(window)), options_(std::move(options)), bar_(*window_),
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
    if (next_) next_->learns_for = learns_for_;
    return std::exchange(next_, std::nullopt);
  }

  session::Observer* observe(const session::RunOptions& run, bool asks_to_save) override {
    view_ = std::make_unique<StudioView>(
        StudioView::Parts{bar_, timeline_, session::live_view(options_.view, run, window_)},
        cli::short_name(run.mesh), asks_to_save);
    return view_.get();
  }

  bool goes_on() override {
    const Wish wish = view_ ? view_->left_for() : Wish{};
    if (!is_wish(wish)) is_over_ = true; // it has ended by itself
    follow(wish);
    return !is_over_;
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
    follow(screen_ == Screen::timeline ? show_timeline()
           : calibration_              ? show_calibration()
                                       : show_start());
    follow(bar_.take_wish());
    follow(timeline_.take_settled());
    if (window_->take_close_request()) follow(Quit{});
    if (is_complete()) ++shown_;
    if (options_.view.frames > 0 && shown_ >= options_.view.frames) is_over_ = true;
  }

  /// Only pictures on which nothing is missing count.
  bool is_complete() {
    if (screen_ == Screen::timeline) {
      edit::WindowEditing* const editing = timeline_.editing();
      if (editing != nullptr && options_.view.frames > 0) editing->session().hurry_pictures();
      return editing != nullptr && editing->is_settled();
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
    const Wish wish = timeline_.show();
    if (!timeline_.is_open()) screen_ = Screen::start;
    return wish;
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

  /// Calibrates this glove, or if none is named, the one that is there.
  void calibrate(std::string glove) {
    for (const std::string& named : options_.gloves)
      if (glove.empty()) glove = named;
    if (glove.empty() && start_) glove = start_->found_glove();
    start_.reset(); // closes it
    screen_ = Screen::start;
    if (glove.empty())
      return bar_.show_error("No glove is here to calibrate. Plug one in, and choose Calibrate "
                             "beside its hand.");
    screen_ = Screen::calibration;
    calibration_ = std::make_unique<WindowCalibration>(*window_, glove);
  }

  void enter_timeline() {
    timeline_.enter();
    start_.reset();
    calibration_.reset();
    screen_ = Screen::timeline;
  }

  void follow(const Wish& wish) {
    if (!timeline_.lets(wish)) return;
    if (const auto* const shape = std::get_if<Shape>(&wish)) next_ = *shape;
    if (const auto* const there = std::get_if<Go>(&wish)) go(*there);
    if (const auto* const file = std::get_if<Open>(&wish)) open(file->file);
    if (std::holds_alternative<Quit>(wish)) is_over_ = true;
  }

  void go(const Go& there) {
    if (there.screen == Screen::shaping) next_ = Shape{};
    if (there.screen == Screen::puppet) next_ = Shape{{}, {}, "face"};
    if (there.screen == Screen::timeline) enter_timeline();
    if (there.screen == Screen::calibration) calibrate(there.glove);
    if (there.screen != Screen::start) return;
    calibration_.reset();
    screen_ = Screen::start;
  }

  void open(const std::string& file) {
    session::keep_recent_file(file);
    if (opens_in_timeline(file)) {
      timeline_.open(file);
      return enter_timeline();
    }
    if (file.ends_with(".toml"))
      next_ = Shape{{}, {}, file};
    else
      next_ = Shape{file};
  }

  std::shared_ptr<viewer::SceneWindow> window_;
  StudioOptions options_;
  Bar bar_;
  std::unique_ptr<StartScreen> start_;
  TimelineTab timeline_;
  std::unique_ptr<WindowCalibration> calibration_;
  std::unique_ptr<StudioView> view_;
  Screen screen_ = Screen::start;
  std::optional<Shape> next_;
  std::string learns_for_; ///< as in Shape
  std::optional<render::Image> last_picture_;
  std::uint32_t shown_ = 0;
  bool is_over_ = false;
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
