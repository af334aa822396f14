#include "session/run_session.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <limits>
#include <utility>

#include <nendo/deform/mesh_file.hpp>
#include <nendo/deform/undo_memory.hpp>

#include "cli/cli.hpp"
#include "session/hold_lights.hpp"
#include "session/loop_change.hpp"
#include "session/loop_thread.hpp"
#include "session/run_keys.hpp"
#include "session/run_picture.hpp"

namespace nendo::session {
namespace {

using std::chrono::milliseconds;

// What a loop lasts at least, before it is made anew.
constexpr milliseconds least_loop(250);

// What is there from the beginning, for some dozens of whole shapes, of which strokes mostly change
// parts.
std::size_t undo_bytes_for(const deform::Mesh& model) noexcept {
  constexpr std::size_t most = std::size_t{64} << 20;
  constexpr std::size_t shapes_of_a_vertex = std::size_t{64} * 3 * sizeof(float);
  return std::min(most,
                  shapes_of_a_vertex * static_cast<std::size_t>(model.vertices.cols() + 1000));
}

std::size_t most_undo_bytes(const RunOptions& options) noexcept {
  return options.undo_memory_mb ? static_cast<std::size_t>(1e6 * *options.undo_memory_mb)
                                : deform::half_of_memory();
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

// No loop drains the rings now: each hand's newest sample is where the next loop begins.
void take_newest(std::vector<gloves::OpenHand>& hands) {
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
  Session(RunOptions options, std::vector<gloves::OpenHand>& hands, deform::Mesh model,
          const Followers& followers)
      : options_(std::move(options)), hands_(hands), model_(std::move(model)),
        loaded_(model_.vertices), followers_(followers), recorder_(model_),
        lights_(options_.loop.switch_action, hands_) {
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
    while (run_loop(picture, keys)) {
      if (const auto renewed = renew(); !renewed) return after_keeping(renewed.error());
    }
    lights_.put_out();
    for (const auto& hand : hands_)
      hand.glove->stop();
    if (const auto kept = keep(options_.out, model_); !kept) return kept.error();
    if (const auto drawn = picture.write(model_.vertices); !drawn) return drawn.error();
    if (followers_.onlooker != nullptr)
      if (const auto ended = followers_.onlooker->end(); !ended) return ended.error();
    return RunOutcome{placed_.loop->stats(), elapsed_s_,   model_.vertices.cols(),
                      placed_.radius,        options_.out, std::move(options_.grants),
                      recorder_.outcomes()};
  }

private:
  Result<void> begin_loop(const std::optional<Carryover>& carryover) {
    options_.loop.input_log = recorder_.input_log_for(options_.recording);
    auto placed = place_loop(options_, hands_, model_, carryover);
    if (!placed) return placed.error();
    placed_ = *std::move(placed);
    if (const auto begun = recorder_.begin(options_, placed_.setup, hands_, model_); !begun)
      return begun.error();
    for (Outlet* outlet : followers_.outlets)
      if (const auto begun = outlet->begin(placed_, model_, hands_); !begun) return begun.error();
    return {};
  }

  // The rings have one pushing thread, which is this one. Full: the loop stands still, and asking
  // again is as good.
  void pass_on_requests() {
    for (Outlet* outlet : followers_.outlets) {
      while (const auto request = outlet->next_request())
        requests_.try_push(*request);
      while (const auto move = outlet->next_wrist())
        wrists_.try_push(*move);
    }
  }

  // The onlooker last: what it wants counts.
  template <class Ask>
  void for_each_follower(Ask&& ask) const {
    for (Outlet* outlet : followers_.outlets)
      ask(*outlet);
    if (followers_.onlooker != nullptr) ask(*followers_.onlooker);
  }

  void keep_what_followers_want(RunKeys& keys) {
    flow::SaveRequest wanted;
    for_each_follower([&](Follower& follower) { wanted.add(follower.next_save_request()); });
    keep_and_tell(wanted, keys);
  }

  void keep_and_tell(const flow::SaveRequest& wanted, RunKeys& keys) {
    if (!wanted.ask_anything()) return;
    const std::string words = keys.keep(wanted, *placed_.loop);
    for_each_follower([&](Follower& follower) { follower.tell(words); });
  }

  // Whether somebody has wanted a change for which it is time.
  bool is_change_due(HostTime loop_began) {
    for_each_follower([&](Follower& follower) { wanted_.add(follower.next_change()); });
    if (!differs(wanted_, placed_, options_)) wanted_ = {};
    return wanted_.asks_anything() && HostClock::now() - loop_began >= least_loop;
  }

  // Until the loop has ended; model_ is then as it left it. True: another one is wanted.
  bool run_loop(RunPicture& picture, RunKeys& keys) {
    flow::DeformLoop& loop = *placed_.loop;
    if (followers_.onlooker != nullptr)
      followers_.onlooker->begin(placed_, model_, hands_, options_);
    LoopThread thread(loop, options_);
    tell_refusals(thread.grants());
    const bool is_another_wanted = watch(thread, picture, keys);
    keep_what_followers_want(keys); // just before the end
    thread.stop();
    elapsed_s_ = to_seconds(HostClock::now() - thread.start);
    model_.vertices = loop.final_shape();
    recorder_.end(model_);
    if (loop.frames().update()) picture.see(loop.frames().front());
    return is_another_wanted;
  }

  // Each loop's thread asks for the same rights; they are told of once.
  void tell_refusals(std::vector<flow::Grant> of_thread) {
    if (told_) return;
    told_ = true;
    std::move(of_thread.begin(), of_thread.end(), std::back_inserter(options_.grants));
    for (const auto& line : flow::refusals(options_.grants))
      cli::note(line);
  }

  bool watch(const LoopThread& thread, RunPicture& picture, RunKeys& keys) {
    auto& frames = placed_.loop->frames();
    const milliseconds patience(followers_.onlooker == nullptr ? 20 : 0);
    HostTime next_report = thread.start;
    bool unreported = false;
    while (!thread.ended && !cli::stop_requested() && !is_over(options_, thread.start)) {
      if (!keys.handle(patience, *placed_.loop)) return false;
      keep_and_tell(keys.next_save_request(), keys);
      placed_.loop->refill_undo();
      const bool fresh = frames.update();
      if (fresh) {
        unreported = true;
        lights_.show(frames.front().held);
        picture.see(frames.front());
      }
      pass_on_requests();
      if (followers_.onlooker != nullptr &&
          followers_.onlooker->look(*placed_.loop, fresh) == Onlooker::Verdict::end)
        return false;
      if (is_change_due(thread.start)) return true;
      if (HostClock::now() < next_report) continue;
      keep_what_followers_want(keys); // no oftener, however often somebody asks
      if (unreported)
        followers_.progress(frames.front(),
                            before_s_ + to_seconds(HostClock::now() - thread.start));
      unreported = false;
      next_report += milliseconds(250);
    }
    return false;
  }

  // What has been shaped is not lost with what cannot go on.
  Error after_keeping(const Error& error) {
    const auto kept = keep(options_.out, model_);
    return kept ? error : kept.error();
  }

  Result<void> renew() {
    before_s_ += elapsed_s_;
    if (options_.duration_s > 0.0)
      options_.duration_s = std::max(1e-3, options_.duration_s - elapsed_s_);
    const Carryover carryover = carryover_of(*placed_.loop);
    const flow::LoopChange change = std::exchange(wanted_, {});
    apply({}, placed_, options_);
    const RunOptions options = options_;
    const deform::Points shape = model_.vertices;
    apply(change, placed_, options_);
    if (change.reset) model_.vertices = loaded_;
    take_newest(hands_);
    const auto begun = begin_loop(carryover);
    if (begun) return {};
    cli::note(begun.error().message + "; the run goes on as it was");
    options_ = options;
    model_.vertices = shape;
    return begin_loop(carryover);
  }

  RunOptions options_;
  std::vector<gloves::OpenHand>& hands_;
  deform::Mesh model_;
  const deform::Points loaded_; ///< what a reset goes back to
  const Followers& followers_;
  flow::LoopChange wanted_; ///< of the next loop, so far
  flow::RequestRing requests_{64};
  flow::WristRing wrists_{64};
  RunRecorder recorder_;
  HoldLights lights_;
  PlacedLoop placed_;
  double before_s_ = 0.0;  ///< of all loops but the latest
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

Result<RunOutcome> run_session(RunOptions options, std::vector<gloves::OpenHand>& hands,
                               deform::Mesh model, const Followers& followers) {
  return Session(std::move(options), hands, std::move(model), followers).run();
}

} // namespace nendo::session
