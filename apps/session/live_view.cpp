#include "session/live_view.hpp"

#ifdef NENDO_WINDOW

#include <filesystem>
#include <utility>

#include <nendo/viewer/live_window.hpp>

#include "session/loop_change.hpp"

namespace nendo::session {

using namespace nendo::viewer;

namespace {

constexpr Size window_size{1180, 760};

class LiveView final : public Onlooker {
public:
  LiveView(std::unique_ptr<LiveWindow> window, const ViewOptions& options, const RunOptions& run)
      : window_(std::move(window)), options_(options) {
    gauges_.model = std::filesystem::path(run.mesh).filename().string();
    gauges_.rate_hz = run.loop.rate_hz;
  }

  void begin(const PlacedLoop& placed, const deform::Mesh& model,
             const std::vector<gloves::OpenHand>& hands, const RunOptions& options) override {
    hands_ = &hands;
    gauges_.recording = options.recording.on;
    requests_ = placed.setup.options.requests;
    wrists_ = placed.setup.options.wrists;
    // The scene keeps its place when a shape that has been pulled about begins a new loop.
    if (!builder_) builder_.emplace(model, placed.setup.placement.units_per_metre);
    window_->begin(placed.loop->layout(), *builder_, settings_of(placed));
    if (changed_at_ != HostTime{})
      gauges_.restart_ms = 1e3 * to_seconds(HostClock::now() - std::exchange(changed_at_, {}));
  }

  Verdict look(flow::DeformLoop& loop, bool fresh) override {
    for (const gloves::OpenHand& hand : *hands_) {
      const std::size_t slot = flow::Placement::index_of(hand.side);
      const auto stats = hand.glove->stats();
      gauges_.gloves[slot] = hand.glove->info().source;
      gauges_.bad_records[slot] = stats.bad_records;
      gauges_.lost[slot] = stats.ring_refused;
    }
    wishes_ = window_->show(loop.frames().front(), fresh, gauges_);
    keepsakes_.add(wishes_.save_request);
    if (fresh) ++shown_;
    for (const auto request : wishes_.requests)
      requests_->try_push(request); // full: the loop stands still, and asking again is as good
    if (wishes_.wrist) wrists_->try_push(*wishes_.wrist); // full: the next one says it again
    if (options_.frames > 0 && shown_ >= options_.frames) return Verdict::end;
    if (wishes_.quit) return Verdict::end;
    if (wishes_.settings || wishes_.reset || wishes_.record) changed_at_ = HostClock::now();
    return Verdict::go_on;
  }

  flow::LoopChange next_change() override {
    flow::LoopChange change{wishes_.settings, wishes_.reset, std::nullopt};
    if (wishes_.record) change.record = !gauges_.recording;
    wishes_ = {};
    return change;
  }

  flow::SaveRequest next_save_request() override { return std::exchange(keepsakes_, {}); }
  void tell(const std::string& words) override { gauges_.told = words; }

  Result<void> end() override {
    if (options_.screenshot.empty()) return {};
    if (shown_ == 0)
      return Error{Errc::failed,
                   "--screenshot " + options_.screenshot +
                       ": the run ended before its first picture; let it last longer"};
    return write_png(options_.screenshot, window_->screenshot());
  }

private:
  std::unique_ptr<LiveWindow> window_;
  ViewOptions options_;
  flow::RequestRing* requests_ = nullptr; ///< the loop's
  flow::WristRing* wrists_ = nullptr;     ///< the loop's
  std::optional<SceneBuilder> builder_;
  const std::vector<gloves::OpenHand>* hands_ = nullptr;
  Gauges gauges_;
  Wishes wishes_;
  flow::SaveRequest keepsakes_; ///< wanted and not asked for yet
  std::uint32_t shown_ = 0;
  HostTime changed_at_{};
};

} // namespace

Result<std::unique_ptr<Onlooker>> open_live_view(const ViewOptions& options,
                                                 const RunOptions& run) {
  auto window = LiveWindow::open("Nendo", window_size);
  if (!window) return window.error();
  return std::unique_ptr<Onlooker>(std::make_unique<LiveView>(*std::move(window), options, run));
}

} // namespace nendo::session

#else

namespace nendo::session {

Result<std::unique_ptr<Onlooker>> open_live_view(const ViewOptions&, const RunOptions&) {
  return Error{Errc::failed, "this nendo was built without a window; install libglfw3-dev, "
                             "libimgui-dev and libgl-dev and build it again, look on in a "
                             "browser with `nendo run --web 8080`, or draw files with "
                             "`nendo picture`"};
}

} // namespace nendo::session

#endif
