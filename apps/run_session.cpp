#include "run_session.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <future>
#include <limits>
#include <thread>
#include <utility>

#include <nendo/deform/mesh_file.hpp>
#include <nendo/driver/devices.hpp>

#include "cli.hpp"
#include "glove_light.hpp"
#include "run_keys.hpp"
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

// For some dozens of whole shapes, of which strokes mostly change parts.
std::size_t undo_bytes_for(const deform::Mesh& model) {
  constexpr std::size_t most = std::size_t{64} << 20;
  constexpr std::size_t a_vertex = 64 * 3 * sizeof(float);
  return std::min(most, a_vertex * static_cast<std::size_t>(model.vertices.cols() + 1000));
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

// Follows the loop from the main thread until it ends or is to end.
void watch(const RunOptions& options, flow::DeformLoop& loop, const std::atomic<bool>& ended,
           HostTime start, HoldLights& lights, RunKeys& keys, const Progress& progress) {
  HostTime next_report = start;
  bool unreported = false;
  while (!ended && !stop_requested() && !is_over(options, start)) {
    if (!keys.obey(milliseconds(20), loop.frames().front())) return;
    if (loop.frames().update()) {
      unreported = true;
      lights.show(loop.frames().front().held);
    }
    if (HostClock::now() < next_report) continue;
    if (unreported) progress(loop.frames().front(), to_seconds(HostClock::now() - start));
    unreported = false;
    next_report += milliseconds(250);
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
                              const deform::Mesh& model) {
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

  const auto placement = placement_for(hands, inputs, model);
  auto setup = setup_of(inputs, placement, loop_options);
  auto loop = std::make_unique<flow::DeformLoop>(model, placement, std::move(inputs), loop_options);
  if (!is_solved(loop->grab_status())) {
    return Error{Errc::failed, "the hands cannot take hold of the model: " +
                                   std::string(deform::describe(loop->grab_status()))};
  }
  return PlacedLoop{std::move(loop), largest_radius, std::move(setup)};
}

Result<RunOutcome> run_session(RunOptions options, const std::vector<OpenHand>& hands,
                               deform::Mesh model, const Progress& progress) {
  flow::RequestRing requests(64);
  options.loop.requests = &requests;
  options.loop.sculptor.deformer.undo_bytes = undo_bytes_for(model);
  RunRecorder recorder(options);
  auto placed = place_loop(recorder.recorded(options), hands, model);
  if (!placed) return placed.error();
  flow::DeformLoop& loop = *placed->loop;
  if (const auto begun = recorder.begin(options, placed->setup, hands, model); !begun)
    return begun.error();
  std::atomic<bool> over{false};
  std::atomic<bool> ended{false};
  std::promise<std::vector<flow::Grant>> prepared;
  const HostTime start = HostClock::now();
  std::thread loop_thread([&] {
    prepared.set_value(flow::make_thread_realtime(options.realtime));
    loop.run(over, ticks_for(options));
    ended = true;
  });
  std::vector<flow::Grant> grants = options.grants;
  for (auto& grant : prepared.get_future().get())
    grants.push_back(std::move(grant));
  for (const auto& line : flow::refusals(grants))
    note(line);
  HoldLights lights(options.loop.switch_action, hands);
  {
    RunKeys keys(requests, loop, model, options.out,
                 options.recording.keep_last_s > 0.0 ? &recorder : nullptr);
    watch(options, loop, ended, start, lights, keys, progress);
  }
  over = true;
  loop_thread.join();
  const double elapsed_s = to_seconds(HostClock::now() - start);
  lights.put_out();
  for (const auto& hand : hands)
    hand.glove->stop();

  model.vertices = loop.final_shape();
  const auto recording = recorder.end(model);
  if (const auto kept = keep(options.out, model); !kept) return kept.error();
  return RunOutcome{loop.stats(),   elapsed_s,   model.vertices.cols(),
                    placed->radius, options.out, std::move(grants),
                    recording};
}

} // namespace nendo::app
