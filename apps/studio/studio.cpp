#include "studio/studio.hpp"

#ifdef NENDO_WINDOW

#include <filesystem>
#include <string_view>
#include <utility>

#include "cli/cli.hpp"
#include "cli/model_files.hpp"
#include "session/kept_state.hpp"
#include "studio/bar.hpp"
#include "studio/calibration_visit.hpp"
#include "studio/start_screen.hpp"
#include "studio/studio_view.hpp"
#include "studio/timeline_screen.hpp"

namespace nendo::studio {
namespace {

bool is_of_timeline(const std::string& file) {
  return file.ends_with(".nendo") || file.ends_with(".timeline.toml");
}

class WindowStudio final : public Studio {
public:
  WindowStudio(std::shared_ptr<viewer::SceneWindow> window, StudioOptions options)
      : window_(std::move(window)), options_(std::move(options)), bar_(*window_) {
    if (!options_.timeline) return;
    timeline_ = std::make_unique<TimelineScreen>(window_, *options_.timeline);
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

  Result<session::Observer*> observe(const session::RunOptions& run, bool asks_to_save) override {
    auto view = session::open_live_view(options_.view, run, window_);
    if (!view) return view.error();
    view_ = std::make_unique<StudioView>(StudioView::Parts{window_, bar_, *std::move(view)},
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
    const bool is_timeline = screen_ == Screen::timeline && timeline_;
    bar_.set({screen_, is_timeline ? timeline_->file() : "",
              is_timeline && timeline_->is_modified(), false});
    const Wish wish = is_timeline    ? show_timeline()
                      : calibration_ ? show_calibration()
                                     : show_start();
    const Wish of_bar = bar_.take_wish();
    follow(is_wish(of_bar) ? of_bar : wish);
    if (window_->take_close_request()) is_over_ = true;
    if (is_complete()) ++shown_;
    if (options_.view.frames > 0 && shown_ >= options_.view.frames) is_over_ = true;
  }

  /// Only pictures on which nothing is missing count.
  bool is_complete() {
    if (timeline_ && screen_ == Screen::timeline)
      return timeline_->editing() != nullptr && timeline_->editing()->is_settled();
    return start_ && start_->is_complete();
  }

  Wish show_start() {
    if (!start_)
      start_ = std::make_unique<StartScreen>(*window_,
                                             StartOptions{options_.gloves, options_.calibration});
    return start_->show(*window_);
  }

  Wish show_timeline() {
    const auto wish = timeline_->show();
    if (wish) return *wish;
    bar_.show_error(wish.error().message);
    timeline_.reset();
    return Go{Screen::start};
  }

  Wish show_calibration() {
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
    calibration_ = std::make_unique<CalibrationVisit>(*window_, glove);
  }

  void open_timeline(const std::string& file) {
    start_.reset();
    calibration_.reset();
    timeline_ = std::make_unique<TimelineScreen>(window_, file);
    screen_ = Screen::timeline;
  }

  void follow(const Wish& wish) {
    if (const auto* const shape = std::get_if<Shape>(&wish)) next_ = *shape;
    if (const auto* const there = std::get_if<Go>(&wish)) go(*there);
    if (const auto* const file = std::get_if<Open>(&wish)) open(file->file);
    if (std::holds_alternative<Quit>(wish)) is_over_ = true;
  }

  void go(const Go& there) {
    if (there.screen == Screen::shaping) next_ = Shape{};
    if (there.screen == Screen::puppet) next_ = Shape{{}, {}, "face"};
    if (there.screen == Screen::timeline) open_timeline("");
    if (there.screen == Screen::calibration) calibrate(there.glove);
    if (there.screen != Screen::start) return;
    calibration_.reset();
    screen_ = Screen::start;
  }

  void open(const std::string& file) {
    if (file.empty()) return bar_.ask_what_to_open();
    session::keep_recent_file(file);
    if (is_of_timeline(file)) return open_timeline(file);
    if (file.ends_with(".toml"))
      next_ = Shape{{}, {}, file};
    else
      next_ = Shape{file};
  }

  std::shared_ptr<viewer::SceneWindow> window_;
  StudioOptions options_;
  Bar bar_;
  std::unique_ptr<StartScreen> start_;
  std::unique_ptr<TimelineScreen> timeline_;
  std::unique_ptr<CalibrationVisit> calibration_;
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
  viewer::WindowLook look;
  look.theme = viewer::theme_named(options.view.theme);
  auto window = viewer::SceneWindow::open(
      "Nendo", look,
      "on a box without a screen `nendo run --web 8080` shows a run in a browser, and `nendo "
      "picture` and `nendo run --picture` draw files");
  if (!window) return window.error();
  return std::unique_ptr<Studio>(std::make_unique<WindowStudio>(*std::move(window), options));
}

} // namespace nendo::studio

#else

namespace nendo::studio {

Result<std::unique_ptr<Studio>> open_studio(const StudioOptions&) {
  return Error{Errc::failed, "this nendo was built without a window; install libglfw3-dev, "
                             "libimgui-dev and libgl-dev and build it again, use a "
                             "browser with `nendo run --web 8080`, or draw files with "
                             "`nendo picture`"};
}

} // namespace nendo::studio

#endif
