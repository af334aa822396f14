#include "run_session.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <future>
#include <iterator>
#include <limits>
#include <thread>
#include <utility>

#include <nendo/deform/mesh_file.hpp>
#include <nendo/driver/devices.hpp>

#include "cli.hpp"
#include "glove_light.hpp"
#include "run_keys.hpp"
#include "run_picture.hpp"
#include "touching_glove.hpp"

namespace nendo::app {
namespace {

using std::chrono::milliseconds;

// Of the model's longest side. On the stage that is 16 cm: a finger shapes what is about it, and
// its neighbours' supports overlap with it enough that no ridge is left between two fingers that
// press together.
constexpr double default_radius_fraction = 0.2;
// A cut of type 2, of the radius: far below the step at which a single finger would fold the
// surface (0.47).
constexpr double piece_fraction = 0.05;

// Both hands that the machine has, or simulated ones. A glove that is there but cannot be used is
// an error.
Result<std::vector<OpenHand>> open_any(Bell* bell) {
  std::vector<OpenHand> hands;
  std::string why;
  for (const Side side : {Side::left, Side::right}) {
    auto hand = open_hand("auto:" + std::string(name_of(side)), side, bell);
    if (hand) {
      hands.push_back(*std::move(hand));
    } else if (hand.error().code != Errc::no_device) {
      return hand.error();
    } else {
      why = hand.error().message;
    }
  }
  if (!hands.empty()) return hands;
  const auto candidates = driver::find_gloves();
  if (std::any_of(candidates.begin(), candidates.end(),
                  [](const auto& c) { return c.identified; })) {
    note(why); // one is plugged in, but does not answer
  }
  note("no glove found, so both hands are simulated (sim); to use a glove name its port, "
       "e.g. --right serial:/dev/ttyUSB0 (`nendo devices` lists them)");
  for (const Side side : {Side::left, Side::right}) {
    auto hand = open_hand("sim", side, bell);
    if (!hand) return hand.error();
    hands.push_back(*std::move(hand));
  }
  return hands;
}

Result<OpenHand> open_touching(const RunOptions& options, const deform::Mesh& model,
                               const std::string& spec, Side side, Bell* bell) {
  auto touching = open_touching_glove(spec, side, model, options.length.size({}));
  if (!touching) return touching.error();
  OpenHand hand = hand_of(std::move(touching->glove), side, bell);
  hand.T_stage_wrist = touching->T_stage_wrist;
  return hand;
}

Result<std::vector<OpenHand>> open_named(const RunOptions& options, const deform::Mesh& model,
                                         Bell* bell) {
  std::vector<OpenHand> hands;
  for (const auto& [spec, side] :
       {std::pair{&options.left, Side::left}, {&options.right, Side::right}}) {
    if (spec->empty()) continue;
    auto hand = is_touching(*spec) ? open_touching(options, model, *spec, side, bell)
                                   : open_hand(*spec, side, bell);
    if (!hand) return hand.error();
    hands.push_back(*std::move(hand));
  }
  return hands;
}

std::vector<flow::HandInput> inputs_of(const std::vector<OpenHand>& hands,
                                       const RunOptions& options) {
  std::vector<flow::HandInput> inputs;
  inputs.reserve(hands.size());
  for (const auto& hand : hands) {
    const hand::HandSkeleton skeleton(hand.side, options.length.size(hand.known.own.size));
    inputs.push_back({hand.ring.get(), skeleton, hand.known.own.calibration, hand.first});
    inputs.back().filter = options.filter;
    inputs.back().swapped = hand.known.swapped.calibration;
    inputs.back().swapped_skeleton.emplace(hand.side, options.length.size(hand.known.swapped.size));
    inputs.back().adapt = hand.known.adapt;
  }
  return inputs;
}

flow::Placement placement_for(const std::vector<OpenHand>& open,
                              const std::vector<flow::HandInput>& inputs,
                              const deform::Mesh& model) {
  std::array<std::optional<flow::Fingertips>, 2> tips;
  for (const auto& hand : inputs) {
    const auto angles = hand::joint_angles(hand.first, hand.calibration);
    tips[flow::Placement::index_of(hand.skeleton.side())] =
        hand.skeleton.pose(angles, Eigen::Isometry3d::Identity()).fingertip_positions();
  }
  flow::Placement placement = flow::place_hands(model, tips);
  for (const auto& hand : open) {
    if (hand.T_stage_wrist)
      placement.T_stage_wrist[flow::Placement::index_of(hand.side)] = *hand.T_stage_wrist;
  }
  return placement;
}

double longest_side(const deform::Mesh& model) {
  return (model.vertices.rowwise().maxCoeff() - model.vertices.rowwise().minCoeff()).maxCoeff();
}

Error bad_radius(const std::string& text, const std::string& why) {
  return {Errc::usage, "--radius " + text + ": " + why +
                           "; use a length > 0 in the mesh's units, five with commas between (or "
                           "ten, left hand first), or leave it out"};
}

Result<deform::Supports> supports_for(const std::string& radius, Eigen::Index fingertips,
                                      double model_size) {
  if (radius.empty())
    return deform::one_radius(default_radius_fraction * (model_size > 0.0 ? model_size : 1.0));
  auto supports = deform::parse_supports_by_point(radius, fingertips);
  if (!supports)
    return bad_radius(radius, "does not fit " + std::to_string(fingertips) + " fingertips");
  return *std::move(supports);
}

std::pair<double, double> least_and_largest(const deform::Supports& supports) {
  double least = supports.shared.front().radius;
  double largest = least;
  const auto count = [&](const deform::Support& support) {
    least = std::min(least, support.radius);
    largest = std::max(largest, support.radius);
  };
  for (const auto& support : supports.shared)
    count(support);
  for (const auto& own : supports.own)
    count(own.support);
  return {least, largest};
}

// A shape that cannot be written where it was wanted, on a full disk say, is not lost if there is
// room elsewhere.
Result<void> keep(const std::string& out, const deform::Mesh& shape) {
  const auto written = deform::write_mesh(out, shape);
  if (written) return {};
  const std::filesystem::path wanted(out);
  const auto elsewhere = std::filesystem::temp_directory_path() / wanted.filename();
  std::error_code ignored;
  if (std::filesystem::exists(elsewhere, ignored) || !deform::write_mesh(elsewhere, shape))
    return written.error();
  return Error{Errc::failed,
               written.error().message + "; the shape is in " + elsewhere.string() + " instead"};
}

Result<void> check_switch(flow::SwitchAction action, const std::vector<OpenHand>& hands) {
  const bool any = std::any_of(hands.begin(), hands.end(), [](const OpenHand& hand) {
    return hand.glove->info().abilities.wrist_switch;
  });
  if (any || action == flow::SwitchAction::none) return {};
  return Error{Errc::usage, "--switch " + std::string(name_of(action)) + ": " +
                                hands.front().glove->info().source +
                                (hands.size() > 1 ? " and the other glove have" : " has") +
                                " no wrist switch that nendo can read; leave --switch out"};
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

// What the main thread follows while a loop runs.
struct Watched {
  const RunOptions& options;
  flow::DeformLoop& loop;
  const LoopThread& thread;
  HoldLights& lights;
  RunPicture& picture;
  RunKeys& keys;
  const Progress& progress;
  Onlooker* onlooker;
};

// Until the loop ends or is to end.
Onlooker::Verdict watch(const Watched& of) {
  using Verdict = Onlooker::Verdict;
  HostTime next_report = of.thread.start;
  bool unreported = false;
  auto verdict = Verdict::go_on;
  const milliseconds patience(of.onlooker == nullptr ? 20 : 0);
  auto& frames = of.loop.frames();
  while (verdict == Verdict::go_on && !of.thread.ended && !stop_requested() &&
         !is_over(of.options, of.thread.start)) {
    if (!of.keys.obey(patience, frames.front())) return Verdict::end;
    const bool fresh = frames.update();
    if (fresh) {
      unreported = true;
      of.lights.show(frames.front().held);
      of.picture.see(frames.front());
    }
    if (of.onlooker != nullptr) verdict = of.onlooker->look(of.loop, fresh);
    if (HostClock::now() < next_report) continue;
    if (unreported) of.progress(frames.front(), to_seconds(HostClock::now() - of.thread.start));
    unreported = false;
    next_report += milliseconds(250);
  }
  return verdict;
}

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

std::size_t undo_bytes_for(const deform::Mesh& model) noexcept {
  constexpr std::size_t most = std::size_t{64} << 20;
  constexpr std::size_t a_vertex = 64 * 3 * sizeof(float);
  return std::min(most, a_vertex * static_cast<std::size_t>(model.vertices.cols() + 1000));
}

Result<void> check_radius(const std::string& text) {
  if (text.empty() || deform::parse_supports_by_point(text, 10)) return {};
  return bad_radius(text, "is none");
}

Result<std::vector<OpenHand>> open_hands(RunOptions& options, const deform::Mesh& model,
                                         Bell& bell) {
  if (options.loop.policy == flow::OverrunPolicy::sample) options.loop.bell = &bell;
  const bool named = !options.left.empty() || !options.right.empty();
  Bell* const rung = options.loop.bell;
  auto hands = named ? open_named(options, model, rung) : open_any(rung);
  if (!hands) return hands;
  if (const auto fine = check_switch(options.loop.switch_action, *hands); !fine)
    return fine.error();
  {
    const flow::InheritedPriority readers(flow::reader_priority(options.realtime.priority));
    if (readers.grant()) options.grants.push_back(*readers.grant());
    for (auto& hand : *hands) {
      if (const auto started = hand.glove->start(*hand.ring); !started) return started.error();
    }
  }
  for (auto& hand : *hands) {
    if (const auto came = wait_for_first_sample(hand); !came) return came.error();
    if (const auto done = calibrate(hand, options.calibration); !done) return done.error();
  }
  return hands;
}

Result<PlacedLoop> place_loop(const RunOptions& options, const std::vector<OpenHand>& hands,
                              const deform::Mesh& model,
                              const std::optional<flow::Placement>& kept_placement) {
  const double size = longest_side(model);
  flow::LoopOptions loop_options = options.loop;
  auto& sculptor = loop_options.sculptor;
  auto inputs = inputs_of(hands, options);
  auto supports = supports_for(options.radius, 5 * static_cast<Eigen::Index>(inputs.size()), size);
  if (!supports) return supports.error();
  const auto [least_radius, largest_radius] = least_and_largest(*supports);
  sculptor.deformer.supports = *std::move(supports);
  sculptor.piece_length = piece_fraction * least_radius;
  // Live fingertips meet; the exact solution for two that nearly touch would tear the surface
  // between them.
  sculptor.deformer.csrbf.merge_fraction = 0.05;

  const auto placement = kept_placement ? *kept_placement : placement_for(hands, inputs, model);
  auto setup = setup_of(inputs, placement, loop_options);
  auto loop = std::make_unique<flow::DeformLoop>(model, placement, std::move(inputs), loop_options);
  if (!is_solved(loop->grab_status())) {
    return Error{Errc::failed, "the hands cannot take hold of the model: " +
                                   std::string(deform::describe(loop->grab_status()))};
  }
  return PlacedLoop{std::move(loop), largest_radius, std::move(setup)};
}

Result<RunOutcome> run_session(RunOptions options, std::vector<OpenHand>& hands, deform::Mesh model,
                               const Progress& progress, Onlooker* onlooker) {
  flow::RequestRing own_requests(64);
  if (options.loop.requests == nullptr) options.loop.requests = &own_requests;
  RunRecorder recorder(options);
  auto placed = place_loop(recorder.recorded(options), hands, model);
  if (!placed) return placed.error();
  if (const auto begun = recorder.begin(options, placed->setup, hands, model); !begun)
    return begun.error();
  RecordingOutcome recording;
  HoldLights lights(options.loop.switch_action, hands);
  RunPicture picture(options.picture, model, placed->setup.options);
  std::vector<flow::Grant> grants = options.grants;
  auto verdict = Onlooker::Verdict::renew;
  double elapsed_s = 0.0;
  for (bool first = true; verdict == Onlooker::Verdict::renew; first = false) {
    if (!first) {
      onlooker->change(options, model);
      take_newest(hands);
      auto anew = place_loop(options, hands, model, placed->setup.placement);
      if (!anew) {
        const auto kept = keep(options.out, model); // what has been shaped is not lost with it
        return kept ? anew.error() : kept.error();
      }
      placed = std::move(anew);
    }
    if (onlooker != nullptr) onlooker->begin(*placed, model, hands);
    LoopThread thread(*placed->loop, options);
    auto of_thread = thread.grants();
    if (first) {
      std::move(of_thread.begin(), of_thread.end(), std::back_inserter(grants));
      for (const auto& line : flow::refusals(grants))
        note(line);
    }
    {
      const bool keeps = first && options.recording.keep_last_s > 0.0;
      RunKeys keys(options, *placed->loop, model, keeps ? &recorder : nullptr);
      verdict = watch({options, *placed->loop, thread, lights, picture, keys, progress, onlooker});
    }
    thread.stop();
    elapsed_s = to_seconds(HostClock::now() - thread.start);
    if (options.duration_s > 0.0)
      options.duration_s = std::max(1e-3, options.duration_s - elapsed_s);
    model.vertices = placed->loop->final_shape();
    if (first) recording = recorder.end(model);
    if (first && verdict == Onlooker::Verdict::renew && options.recording.wanted())
      note("the recording ends here, because the loop is made anew");
    if (placed->loop->frames().update()) picture.see(placed->loop->frames().front());
  }
  lights.put_out();
  for (const auto& hand : hands)
    hand.glove->stop();
  if (const auto kept = keep(options.out, model); !kept) return kept.error();
  if (const auto drawn = picture.write(model.vertices); !drawn) return drawn.error();
  return RunOutcome{
      placed->loop->stats(), elapsed_s, model.vertices.cols(), placed->radius, options.out,
      std::move(grants),     recording};
}

} // namespace nendo::app
