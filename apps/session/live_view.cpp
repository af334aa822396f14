#include "session/views.hpp"

#ifdef NENDO_WINDOW

#include <filesystem>
#include <utility>

#include "cli/model_files.hpp"
#include "session/kept_state.hpp"
#include "viewer/live_window.hpp"
#include "viewer/puppet_editor.hpp"

namespace nendo::session {

using namespace nendo::render;
using namespace nendo::viewer;

namespace {

class LiveView final : public WindowView {
public:
  LiveView(std::unique_ptr<LiveWindow> window, const ViewOptions& options, const RunOptions& run)
      : window_(std::move(window)), options_(options) {
    model_name_ = cli::short_name(run.mesh);
    gauges_.model = model_name_;
    if (run.over)
      gauges_.model += " over " + std::filesystem::path(run.over->file).filename().string();
    gauges_.rate_hz = run.loop.rate_hz;
    // Pictures of the window are the same for everyone.
    if (options.screenshot.empty() && are_hints_due()) window_->show_hints();
    edits_ = !run.puppet_file.empty() && !run.puppet; // there is none yet
  }

  void loop_begins(const LoopStart& start) override {
    const PlacedLoop& placed = start.placed;
    const SceneBuilder builder(start.model, placed.setup.placement.units_per_metre);
    window_->begin(placed.loop->changes().layout(), builder, placed.loop->changes().settings());
    window_->scene_window().parts().contacts = options_.contact;
    window_->editor().begin(start.model, model_name_, placed.loop->changes().puppet(0));
    if (edits_) window_->editor().turn(true);
  }

  void update(const RunStatus& status, Asks& asks) override {
    gauges_.devices = device_lines(status.devices);
    gauges_.facts = status.facts;
    gauges_.parts = status.model.parts;
    gauges_.vertices = status.model.mesh.vertex_count();
    if (model_ != status.frame.model) {
      show_again(status);
      window_->editor().set_model(status.model.mesh);
    }
    window_->editor().follow(status.puppet, status.frame);
    const bool had_hints = window_->has_hints();
    const Commands given = window_->show(status.frame, status.fresh, gauges_);
    if (had_hints && !window_->has_hints()) keep_hints_closed();
    if (auto puppet = window_->editor().take()) asks.emplace_back(std::move(puppet));
    asks.insert(asks.end(), given.begin(), given.end());
    if (status.fresh) ++shown_;
    if (options_.frames > 0 && shown_ >= options_.frames) asks.emplace_back(flow::EndRun{});
  }

  LiveWindow& window() noexcept override { return *window_; }
  void show_again(const RunStatus& status) override {
    model_ = status.frame.model;
    window_->set_model(status.model.layout(),
                       SceneBuilder(status.model.mesh, status.frame.units_per_metre));
  }
  void report(const Report& message) override {
    gauges_.report = message.text;
    gauges_.report_is_error = message.is_error;
  }
  bool sets_pace() const noexcept override { return true; }
  const PictureTimes* picture_times() const noexcept override { return &window_->picture_times(); }
  bool stays_open() const noexcept override { return true; }

  Result<void> end() override {
    if (options_.screenshot.empty()) return {};
    if (shown_ == 0)
      return Error{Errc::failed,
                   "--screenshot " + options_.screenshot +
                       ": the run ended before its first picture; let it last longer"};
    return write_png(options_.screenshot, window_->scene_window().screenshot());
  }

private:
  std::unique_ptr<LiveWindow> window_;
  ViewOptions options_;
  Gauges gauges_;
  std::string model_name_; ///< in a puppet's file
  std::uint32_t shown_ = 0;
  bool edits_ = false;      ///< from the beginning
  std::uint32_t model_ = 0; ///< that the window has
};

} // namespace

Result<std::shared_ptr<SceneWindow>> open_window(const ViewOptions& options) {
  WindowLook look;
  look.theme = theme_named(options.theme);
  constexpr const char* remedy =
      "on a box without a screen `nendo studio --web 8080` and `nendo run --web 8080` show a page "
      "in a browser, and `nendo picture` and `nendo run --picture` draw files";
  auto window = SceneWindow::open("Nendo", look, remedy);
  if (!window) return window.error();
  return std::shared_ptr<SceneWindow>(*std::move(window));
}

std::unique_ptr<WindowView> live_view(const ViewOptions& options, const RunOptions& run,
                                      std::shared_ptr<SceneWindow> window) {
  return std::make_unique<LiveView>(std::make_unique<LiveWindow>(std::move(window)), options, run);
}

} // namespace nendo::session

#else

namespace nendo::session {

Result<std::shared_ptr<viewer::SceneWindow>> open_window(const ViewOptions&) {
  return Error{Errc::failed, "this nendo was built without a window; install libglfw3-dev, "
                             "libimgui-dev and libgl-dev and build it again, use a browser with "
                             "`nendo studio --web 8080` or `nendo run --web 8080`, or draw files "
                             "with `nendo picture`"};
}

std::unique_ptr<WindowView> live_view(const ViewOptions&, const RunOptions&,
                                      std::shared_ptr<viewer::SceneWindow>) {
  return nullptr; // there is no window for it
}

} // namespace nendo::session

#endif
