#include "run_session.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <future>
#include <iterator>
#include <limits>
#include <thread>
#include <utility>

#include <nendo/base/usable_memory.hpp>
#include <nendo/deform/mesh_file.hpp>

#include "cli.hpp"
#include "glove_light.hpp"
#include "run_keys.hpp"
#include "run_picture.hpp"

namespace nendo::app {
namespace {

using std::chrono::milliseconds;

// What is there from the beginning, for some dozens of whole shapes, of which strokes mostly change
// parts.
std::size_t undo_bytes_for(const deform::Mesh& model) noexcept {
  constexpr std::size_t most = std::size_t{64} << 20;
  constexpr std::size_t shapes_of_a_vertex = 64 * 3 * sizeof(float);
  return std::min(most,
                  shapes_of_a_vertex * static_cast<std::size_t>(model.vertices.cols() + 1000));
}

std::size_t most_undo_bytes(const RunOptions& options) noexcept {
  return options.undo_memory_mb ? static_cast<std::size_t>(1e6 * *options.undo_memory_mb)
                                : usable_memory() / 2;
}

// A shape that cannot be written where it was wanted, on a full disk say, is not lost if there is
// room elsewhere.
Result<void> keep(const std::string& out, const deform::Mesh& shape) {
  const auto written = deform::write_mesh(out, shape);
  if (written) return {};
  const std::filesystem::path wanted(out);
  std::error_code ignored, no_folder;
  auto folder = std::filesystem::temp_directory_path(no_folder);
  if (no_folder) folder = "/tmp"; // TMPDIR may name a place that is not there
  const auto elsewhere = folder / wanted.filename();
  if (std::filesystem::exists(elsewhere, ignored) || !deform::write_mesh(elsewhere, shape))
    return written.error();
  return Error{Errc::failed,
               written.error().message + "; the shape is in " + elsewhere.string() + " instead"};
}

// The lights of the gloves whose switches do something: lit while the hands hold the model. Given
// from here, because Glove::give takes a lock, which is nothing for the loop.
class HoldLights {
public:
  HoldLights(flow::SwitchAction action, const std::vector<OpenHand>& hands) {
    if (action == flow::SwitchAction::none) return;
    for (const auto& hand : hands)
      lights_.push_back(std::make_unique<GloveLight>(*hand.glove));
  }
  void show(bool held) noexcept {
    for (const auto& light : lights_)
      light->show(held);
  }
  void put_out() noexcept {
    for (const auto& light : lights_)
      light->put_out();
  }

private:
  std::vector<std::unique_ptr<GloveLight>> lights_;
};

// The thread on which a loop runs.
class LoopThread {
public:
  LoopThread(flow::DeformLoop& loop, const RunOptions& options)
      : start(HostClock::now()), thread_([this, &loop, &options] {
          prepared_.set_value(flow::make_thread_realtime(options.realtime));
          loop.run(over_, ticks_for(options));
          ended = true;
        }) {}
  ~LoopThread() { stop(); }
  LoopThread(const LoopThread&) = delete;
  LoopThread& operator=(const LoopThread&) = delete;

  std::vector<flow::Grant> grants() { return prepared_.get_future().get(); }
  void stop() {
    over_ = true;
    if (thread_.joinable()) thread_.join();
  }

  const HostTime start;
  std::atomic<bool> ended{false};

private:
  std::atomic<bool> over_{false};
  std::promise<std::vector<flow::Grant>> prepared_;
  std::thread thread_;
};

// No loop drains the rings now: each hand's newest sample is where the next loop begins.
void take_newest(std::vector<OpenHand>& hands) {
  for (auto& hand : hands) {
    const HostTime end = HostClock::now() + milliseconds(25); // a silent glove keeps its pose
    bool any = false;
    do {
      while (hand.ring->try_pop(hand.first))
        any = true;
      if (!any) std::this_thread::sleep_for(milliseconds(1));
    } while (!any && HostClock::now() < end);
  }
}

// One run: its loop, which may be made anew, and what follows it.
class Session {
public:
  Session(RunOptions options, std::vector<OpenHand>& hands, deform::Mesh model,
          const Followers& followers)
      : options_(std::move(options)), hands_(hands), model_(std::move(model)),
        followers_(followers), recorder_(model_), lights_(options_.loop.switch_action, hands_) {
    options_.loop.requests = &requests_;
    options_.loop.wrists = &wrists_;
    const std::size_t most = most_undo_bytes(options_);
    const std::size_t at_once = std::min(undo_bytes_for(model_), most);
    options_.loop.sculptor.deformer.undo_bytes = at_once;
    options_.loop.undo_most_bytes = most - at_once;
    options_.loop.sinks.assign(followers_.outlets.begin(), followers_.outlets.end());
  }

  Result<RunOutcome> run() {
    if (const auto begun = begin_loop({}); !begun) return begun.error();
    RunPicture picture(options_.picture, model_, placed_.setup.options);
    RunKeys keys(options_, model_, recorder_);
    while (run_loop(picture, keys) == Verdict::renew) {
      if (const auto renewed = renew(); !renewed) return after_keeping(renewed.error());
    }
    lights_.put_out();
    for (const auto& hand : hands_)
      hand.glove->stop();
    if (const auto kept = keep(options_.out, model_); !kept) return kept.error();
    if (const auto drawn = picture.write(model_.vertices); !drawn) return drawn.error();
    return RunOutcome{placed_.loop->stats(), elapsed_s_,   model_.vertices.cols(),
                      placed_.radius,        options_.out, std::move(options_.grants),
                      recorder_.outcomes()};
  }

private:
  using Verdict = Onlooker::Verdict;

  Result<void> begin_loop(const std::optional<flow::Placement>& placement) {
    options_.loop.tape = recorder_.tape_for(options_.recording);
    auto placed = place_loop(options_, hands_, model_, placement);
    if (!placed) return placed.error();
    placed_ = *std::move(placed);
    if (const auto begun = recorder_.begin(options_, placed_.setup, hands_, model_); !begun)
      return begun.error();
    for (Outlet* outlet : followers_.outlets)
      if (const auto begun = outlet->begin(placed_, model_, hands_); !begun) return begun.error();
    return {};
  }

  // The ring has one pushing thread, which is this one.
  void pass_on_requests() {
    for (Outlet* outlet : followers_.outlets)
      while (const auto request = outlet->next_request())
        requests_.try_push(*request); // full: the loop stands still, and asking again is as good
  }

  // Until the loop has ended; model_ is then as it left it.
  Verdict run_loop(RunPicture& picture, RunKeys& keys) {
    flow::DeformLoop& loop = *placed_.loop;
    if (followers_.onlooker != nullptr)
      followers_.onlooker->begin(placed_, model_, hands_, options_);
    LoopThread thread(loop, options_);
    tell_refusals(thread.grants());
    const Verdict verdict = watch(thread, picture, keys);
    thread.stop();
    elapsed_s_ = to_seconds(HostClock::now() - thread.start);
    model_.vertices = loop.final_shape();
    recorder_.end(model_);
    if (loop.frames().update()) picture.see(loop.frames().front());
    return verdict;
  }

  // Each loop's thread asks for the same rights; they are told of once.
  void tell_refusals(std::vector<flow::Grant> of_thread) {
    if (told_) return;
    told_ = true;
    std::move(of_thread.begin(), of_thread.end(), std::back_inserter(options_.grants));
    for (const auto& line : flow::refusals(options_.grants))
      note(line);
  }

  Verdict watch(const LoopThread& thread, RunPicture& picture, RunKeys& keys) {
    auto& frames = placed_.loop->frames();
    const milliseconds patience(followers_.onlooker == nullptr ? 20 : 0);
    HostTime next_report = thread.start;
    bool unreported = false;
    auto verdict = Verdict::go_on;
    while (verdict == Verdict::go_on && !thread.ended && !stop_requested() &&
           !is_over(options_, thread.start)) {
      if (!keys.obey(patience, *placed_.loop)) return Verdict::end;
      placed_.loop->refill_undo();
      const bool fresh = frames.update();
      if (fresh) {
        unreported = true;
        lights_.show(frames.front().held);
        picture.see(frames.front());
      }
      pass_on_requests();
      if (followers_.onlooker != nullptr) verdict = followers_.onlooker->look(*placed_.loop, fresh);
      if (HostClock::now() < next_report) continue;
      if (unreported)
        followers_.progress(frames.front(), to_seconds(HostClock::now() - thread.start));
      unreported = false;
      next_report += milliseconds(250);
    }
    return verdict;
  }

  // What has been shaped is not lost with what cannot go on.
  Error after_keeping(const Error& error) {
    const auto kept = keep(options_.out, model_);
    return kept ? error : kept.error();
  }

  Result<void> renew() {
    if (options_.duration_s > 0.0)
      options_.duration_s = std::max(1e-3, options_.duration_s - elapsed_s_);
    followers_.onlooker->change(options_, model_);
    take_newest(hands_);
    return begin_loop(placed_.loop->placement());
  }

  RunOptions options_;
  std::vector<OpenHand>& hands_;
  deform::Mesh model_;
  const Followers& followers_;
  flow::RequestRing requests_{64};
  flow::WristRing wrists_{64};
  RunRecorder recorder_;
  HoldLights lights_;
  PlacedLoop placed_;
  double elapsed_s_ = 0.0; ///< of the latest loop
  bool told_ = false;
};

} // namespace

std::uint64_t ticks_for(const RunOptions& options) noexcept {
  // Ticks that follow samples, or slip, do not measure time.
  const auto policy = options.loop.policy;
  const bool on_grid =
      policy == flow::OverrunPolicy::skip || policy == flow::OverrunPolicy::catch_up;
  if (options.duration_s <= 0.0 || !on_grid) return std::numeric_limits<std::uint64_t>::max();
  return static_cast<std::uint64_t>(
      std::max(1.0, std::round(options.duration_s * options.loop.rate_hz)));
}

bool is_over(const RunOptions& options, HostTime start) noexcept {
  if (options.duration_s <= 0.0) return false;
  const bool on_grid = ticks_for(options) != std::numeric_limits<std::uint64_t>::max();
  return !on_grid && to_seconds(HostClock::now() - start) >= options.duration_s;
}

Result<RunOutcome> run_session(RunOptions options, std::vector<OpenHand>& hands, deform::Mesh model,
                               const Followers& followers) {
  return Session(std::move(options), hands, std::move(model), followers).run();
}

} // namespace nendo::app
