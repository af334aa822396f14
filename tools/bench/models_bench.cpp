// nendo bench models: what it costs a tick to continue with another version of the model or with
// other masks, and whether changes of radius make a loop late.

#include <array>
#include <atomic>
#include <cmath>
#include <memory>
#include <thread>
#include <vector>

#include <nlohmann/json.hpp>

#include <nendo/flow/deform_loop.hpp>
#include <nendo/flow/realtime.hpp>

#include "bench/bench.hpp"
#include "bench/percentiles.hpp"
#include "bench/plane_memory.hpp"
#include "cli/cli.hpp"
#include "cli/print.hpp"
#include "reference/table1.hpp"

namespace nendo::bench::models_bench {
namespace {

struct Options {
  unsigned cells = 500;
  unsigned repetitions = 5;
  unsigned seconds = 30;
  bool json = false;
};

double us(HostClock::duration time) {
  return std::chrono::duration<double, std::micro>(time).count();
}

GloveSample resting_hand(HostTime now, int counts) {
  GloveSample sample;
  sample.side = Side::right;
  sample.present = sensors_22;
  sample.arrival = now;
  const hand::Calibration calibration = hand::default_calibration();
  for (std::size_t slot = 0; slot < sensor_slots; ++slot)
    sample.raw[slot].value =
        static_cast<std::uint16_t>(calibration[static_cast<Sensor>(slot)].offset_counts + counts);
  return sample;
}

/// Quads of the paper's plane.
deform::Mesh plane(unsigned cells) {
  deform::Mesh mesh;
  mesh.vertices = reference::table1_plane(static_cast<int>(cells));
  const auto side = static_cast<std::uint32_t>(std::lround(std::sqrt(mesh.vertices.cols())));
  for (std::uint32_t row = 0; row + 1 < side; ++row)
    for (std::uint32_t column = 0; column + 1 < side; ++column) {
      const std::uint32_t at = row * side + column;
      mesh.face_corners.insert(mesh.face_corners.end(), {at, at + 1, at + side + 1, at + side});
      mesh.face_starts.push_back(static_cast<std::uint32_t>(mesh.face_corners.size()));
    }
  return mesh;
}

/// A loop over a plane, whose ticks are timed one by one.
class TimedLoop {
public:
  TimedLoop(const deform::Mesh& model, bool held, double rate_hz = 90.0) {
    flow::HandInput hand;
    hand.ring = &ring_;
    hand.first = resting_hand(HostClock::now(), 0);
    flow::LoopOptions options;
    options.commands = &commands_;
    options.held = held;
    options.rate_hz = rate_hz;
    options.sculptor.deformer.supports =
        deform::one_radius(0.2 * deform::diagonal_of(model.vertices));
    options.undo_max_bytes = std::size_t{1} << 30;
    flow::Placement placement;
    placement.units_per_metre = deform::diagonal_of(model.vertices);
    loop_ = std::make_unique<flow::DeformLoop>(model, placement, std::vector{hand}, options);
  }

  flow::DeformLoop& loop() noexcept { return *loop_; }
  double tick_us() {
    const HostTime now = HostClock::now();
    bend();
    const HostTime begin = HostClock::now();
    loop_->tick(number_, now);
    const double time = us(HostClock::now() - begin);
    loop_->frames().update();
    return time;
  }
  /// Of a request's tick, and of the tick that takes the version for which it waits.
  double step_us(flow::Request request) {
    commands_.try_push(request);
    tick_us();
    if (const auto& awaited = loop_->frames().front().awaited)
      static_cast<void>(loop_->changes().change_to(*awaited));
    return tick_us();
  }
  /// Of the tick that takes masks: a ball, and in turn all but that.
  double mask_us() {
    puppet::Puppet puppet;
    puppet.masks.push_back({loop_->changes().model(0)->mesh.vertices.col(0), 0.3});
    puppet.inverted = number_ % 2 == 0;
    if (!loop_->changes().change_puppet(
            std::make_shared<const puppet::Rig>(puppet, deform::Points(3, 0))))
      return 0.0;
    return tick_us();
  }
  // No ring is full, since the loop drains both in each tick, and a second thread that runs it has
  // many ticks between two calls.
  void bend() { ring_.try_push(resting_hand(HostClock::now(), static_cast<int>(++number_ % 8))); }
  void commit() { commands_.try_push(flow::Request::commit); }

private:
  SampleRing ring_{64};
  flow::CommandRing commands_{16};
  std::unique_ptr<flow::DeformLoop> loop_;
  std::uint64_t number_ = 0;
};

struct Figures {
  std::size_t vertices = 0;
  std::vector<double> ordinary_us, commit_us, new_us, undo_us, redo_us, make_us, finish_us, mask_us;
};

Figures measure(const deform::Mesh& model, bool held, unsigned repetitions) {
  Figures figures;
  for (unsigned repetition = 0; repetition < repetitions && !cli::stop_requested(); ++repetition) {
    TimedLoop timed(model, held);
    flow::DeformLoop& loop = timed.loop();
    timed.tick_us();
    const HostTime begin = HostClock::now();
    flow::PendingModel finer(loop.changes().newest_model());
    figures.make_us.push_back(us(HostClock::now() - begin));
    static_cast<void>(loop.changes().hold_still());
    timed.tick_us();
    const HostTime still = HostClock::now();
    loop.changes().is_still(); // which change_model() requires
    static_cast<void>(loop.changes().change_model(finer));
    figures.finish_us.push_back(us(HostClock::now() - still));
    figures.new_us.push_back(timed.tick_us());
    figures.vertices = loop.changes().newest_model().layout().vertex_count();
    for (int tick = 0; tick < 20; ++tick)
      figures.ordinary_us.push_back(timed.tick_us());
    timed.commit();
    figures.commit_us.push_back(timed.tick_us());
    loop.changes().is_changing(); // frees what was before
    if (held) continue;           // an undo would first take what the hands hold
    figures.undo_us.push_back(timed.step_us(flow::Request::undo));
    loop.changes().is_changing();
    figures.redo_us.push_back(timed.step_us(flow::Request::redo));
    loop.changes().is_changing();
    figures.mask_us.push_back(timed.mask_us());
  }
  return figures;
}

void print(const Options& options, bool held, const Figures& figures) {
  if (options.json) {
    cli::print_line({{"measured", "models"},
                     {"vertices", figures.vertices},
                     {"held", held},
                     {"ordinary_us", median(figures.ordinary_us)},
                     {"commit_us", median(figures.commit_us)},
                     {"new_us", median(figures.new_us)},
                     {"undo_us", median(figures.undo_us)},
                     {"redo_us", median(figures.redo_us)},
                     {"mask_us", median(figures.mask_us)},
                     {"make_ms", median(figures.make_us) / 1e3},
                     {"finish_ms", median(figures.finish_us) / 1e3}});
    return;
  }
  cli::print("{} vertices, hands that {} the model; medians in us per tick\n", figures.vertices,
             held ? "hold" : "have released");
  cli::print(
      "  an ordinary tick {:10.1f}\n  a commit         {:10.1f}\n  a new version    {:10.1f}\n",
      median(figures.ordinary_us), median(figures.commit_us), median(figures.new_us));
  if (!held)
    cli::print(
        "  an undo          {:10.1f}\n  a redo           {:10.1f}\n  other masks      {:10.1f}\n",
        median(figures.undo_us), median(figures.redo_us), median(figures.mask_us));
  cli::print(
      "  beside the loop: {:.0f} ms to make the version, and {:.0f} ms while the loop waits\n",
      median(figures.make_us) / 1e3, median(figures.finish_us) / 1e3);
}

/// A loop at 1 kHz, in whose second half the radius changes 1,000 times a minute.
void measure_changes(const Options& options) {
  constexpr double rate_hz = 1000.0;
  constexpr unsigned changes_per_minute = 1000;
  TimedLoop timed(plane(70), true, rate_hz);
  flow::DeformLoop& loop = timed.loop();
  std::atomic<bool> stop{false};
  std::atomic<int> half{0};
  std::array<std::uint64_t, 2> missed{}, overruns{};
  std::thread thread([&] {
    flow::make_thread_realtime({});
    for (std::size_t at = 0; at < missed.size(); ++at, ++half) {
      loop.run(stop, static_cast<std::uint64_t>(rate_hz) * options.seconds);
      missed[at] = loop.stats().missed - (at == 0 ? 0 : missed[0]);
      overruns[at] = loop.stats().overruns - (at == 0 ? 0 : overruns[0]);
    }
  });
  std::uint64_t changes = 0;
  flow::LoopSettings settings = loop.changes().settings();
  const double first_m = settings.radius_m[0];
  for (HostTime next = HostClock::now(); half < 2 && !cli::stop_requested();) {
    std::this_thread::sleep_until(next += std::chrono::milliseconds(60'000 / changes_per_minute));
    timed.bend(); // no tick without something to do
    loop.frames().update();
    loop.changes().refill_undo();
    if (half == 0) continue;
    settings.radius_m.fill(first_m * (1.0 + 0.01 * static_cast<double>(++changes % 30)));
    static_cast<void>(loop.changes().change_settings(settings));
  }
  stop = cli::stop_requested().load();
  thread.join();
  if (options.json) {
    cli::print_line({{"measured", "changes"},
                     {"seconds", options.seconds},
                     {"changes", changes},
                     {"taken", loop.stats().changes},
                     {"missed_without", missed[0]},
                     {"missed_with", missed[1]},
                     {"overruns_without", overruns[0]},
                     {"overruns_with", overruns[1]}});
    return;
  }
  cli::print("at 1 kHz, {} s without and {} s with {} changes of radius: {} and {} missed "
             "deadlines, {} and {} overruns\n",
             options.seconds, options.seconds, changes, missed[0], missed[1], overruns[0],
             overruns[1]);
}

int run(const Options& options) {
  if (options.cells < 10 || options.cells > 1000 || options.repetitions < 1)
    return cli::report({Errc::usage, "--cells: use 10 to 1000; --repetitions: use 1 or more"});
  if (!has_memory_for_plane(static_cast<int>(2 * options.cells), "models"))
    return static_cast<int>(Errc::failed);
  cli::install_stop_signals();
  const deform::Mesh model = plane(options.cells);
  for (const bool held : {false, true})
    print(options, held, measure(model, held, options.repetitions));
  if (options.seconds > 0) measure_changes(options);
  return 0;
}

} // namespace
} // namespace nendo::bench::models_bench

void nendo::bench::add_models(cli::Command& bench) {
  using namespace models_bench;
  cli::Command command = bench.add_command(
      "models",
      "Measures the cost of a subdivided model for the tick that accepts it, and of its undo");
  Options& options = command.on_chosen<Options>(run);
  command.add_option("--cells", options.cells,
                     "Cells per side of the plane, before it is subdivided");
  command.add_option("--repetitions", options.repetitions,
                     "Number of loops, of which the median is reported");
  command.add_option(
      "--seconds", options.seconds,
      "Seconds that a loop runs without, and then with changes of the radius; 0: none");
  command.add_flag("--json", options.json, "One JSON object per line");
}
