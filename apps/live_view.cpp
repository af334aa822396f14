#include "live_view.hpp"

#ifdef NENDO_WINDOW

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <utility>

#include <nendo/viewer/live_window.hpp>

#include "cli.hpp"

namespace nendo::app {

using namespace nendo::viewer;

namespace {

constexpr Size window_size{1180, 760};

// As --radius takes them.
std::string radii_text(const LoopSettings& settings, double units_per_metre) {
  std::string text;
  for (const double radius_m : settings.radius_m) {
    char number[40];
    std::snprintf(number, sizeof number, "%.9g", radius_m * units_per_metre);
    text += (text.empty() ? "" : ",") + std::string(number);
  }
  return text;
}

class LiveView final : public Onlooker {
public:
  LiveView(std::unique_ptr<LiveWindow> window, const ViewOptions& options, const RunOptions& run,
           deform::Points loaded)
      : window_(std::move(window)), options_(options), loaded_(std::move(loaded)) {
    gauges_.model = std::filesystem::path(run.mesh).filename().string();
    gauges_.rate_hz = run.loop.rate_hz;
  }

  void begin(const PlacedLoop& placed, const deform::Mesh& model,
             const std::vector<OpenHand>& hands, const RunOptions& options) override {
    hands_ = &hands;
    gauges_.recording = options.recording.on;
    requests_ = placed.setup.options.requests;
    wrists_ = placed.setup.options.wrists;
    units_per_metre_ = placed.setup.placement.units_per_metre;
    // The scene keeps its place when a shape that has been pulled about begins a new loop.
    if (!builder_) builder_.emplace(model, units_per_metre_);
    const auto& deformer = placed.setup.options.sculptor.deformer;
    settings_ = {placed.setup.options.sculptor.mode, deformer.csrbf.kernel,
                 radii_on_stage(deformer.supports, units_per_metre_)};
    window_->begin(placed.loop->layout(), *builder_, settings_);
    if (changed_at_ != HostTime{})
      gauges_.restart_ms = 1e3 * to_seconds(HostClock::now() - changed_at_);
  }

  Verdict look(flow::DeformLoop& loop, bool fresh) override {
    for (const OpenHand& hand : *hands_) {
      const std::size_t slot = flow::Placement::index_of(hand.side);
      const auto stats = hand.glove->stats();
      gauges_.gloves[slot] = hand.glove->info().source;
      gauges_.bad_records[slot] = stats.bad_records;
      gauges_.lost[slot] = stats.ring_refused;
    }
    wishes_ = window_->show(loop.frames().front(), fresh, gauges_);
    if (fresh) ++shown_;
    for (const auto request : wishes_.requests)
      requests_->try_push(request); // full: the loop stands still, and asking again is as good
    if (wishes_.wrist) wrists_->try_push(*wishes_.wrist); // full: the next one says it again
    if (options_.frames > 0 && shown_ >= options_.frames) {
      if (!options_.screenshot.empty())
        if (const auto done = write_png(options_.screenshot, window_->screenshot()); !done)
          report(done.error());
      return Verdict::end;
    }
    if (wishes_.quit) return Verdict::end;
    if (!wishes_.settings && !wishes_.reset && !wishes_.record) return Verdict::go_on;
    changed_at_ = HostClock::now();
    return Verdict::renew;
  }

  void change(RunOptions& options, deform::Mesh& model) override {
    if (wishes_.reset) model.vertices = loaded_;
    if (wishes_.record) options.recording.on = !options.recording.on;
    if (!wishes_.settings) return;
    options.loop.sculptor.mode = wishes_.settings->mode;
    options.loop.sculptor.deformer.csrbf.kernel = wishes_.settings->kernel;
    if (wishes_.settings->radius_m != settings_.radius_m || options.radius.empty())
      options.radius = radii_text(*wishes_.settings, units_per_metre_);
  }

private:
  std::unique_ptr<LiveWindow> window_;
  ViewOptions options_;
  flow::RequestRing* requests_ = nullptr; ///< the loop's
  flow::WristRing* wrists_ = nullptr;     ///< the loop's
  deform::Points loaded_;
  std::optional<SceneBuilder> builder_;
  const std::vector<OpenHand>* hands_ = nullptr;
  LoopSettings settings_;
  Gauges gauges_;
  Wishes wishes_;
  double units_per_metre_ = 1.0;
  std::uint32_t shown_ = 0;
  HostTime changed_at_{};
};

} // namespace

Result<std::unique_ptr<Onlooker>> open_live_view(const ViewOptions& options, const RunOptions& run,
                                                 const deform::Mesh& model) {
  auto window = LiveWindow::open("Nendo", window_size);
  if (!window) return window.error();
  return std::unique_ptr<Onlooker>(
      std::make_unique<LiveView>(*std::move(window), options, run, model.vertices));
}

} // namespace nendo::app

#else

namespace nendo::app {

Result<std::unique_ptr<Onlooker>> open_live_view(const ViewOptions&, const RunOptions&,
                                                 const deform::Mesh&) {
  return Error{Errc::failed, "this nendo was built without a window; install libglfw3-dev, "
                             "libimgui-dev and libgl-dev and build it again, look on in a "
                             "browser with `nendo run --web 8080`, or draw files with "
                             "`nendo picture`"};
}

} // namespace nendo::app

#endif
