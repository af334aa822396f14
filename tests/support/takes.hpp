#pragma once
// Makes recordings for tests, of a loop whose rings the test fills, and of random entries.

#include <algorithm>
#include <fstream>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include <nendo/recording/recorder.hpp>

#include "support/any_puppet.hpp"
#include "support/flow_fixtures.hpp"
#include "support/late_maker.hpp"
#include "support/temporary_folder.hpp"

namespace nendo::test {

inline std::string file_bytes(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

inline void write_bytes(const std::filesystem::path& path, std::string_view bytes) {
  std::ofstream(path, std::ios::binary)
      .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

/// Returns the setup that a recorder of this loop would get.
inline recording::Setup setup_of(const LoopUnderTest& test) {
  recording::Setup setup = recording::begin_setup("test 1.0");
  setup.wearer = "anna";
  for (const auto& input : test.inputs) {
    driver::GloveInfo glove;
    glove.source = "sim";
    glove.model = "a glove of the test's";
    glove.side = input.side;
    glove.sensors = sensors_22;
    glove.rate_hz = 90.0;
    setup.gloves.push_back(glove);
    setup.hands.push_back(input);
  }
  for (std::size_t at = 0; at < test.poses.size(); ++at) {
    driver::TrackerInfo tracker;
    tracker.source = "sim:orbit";
    tracker.model = "a tracker of the test's";
    tracker.rate_hz = 240.0;
    tracker.facts = {{"firmware", "1.0"}};
    const auto station = static_cast<std::uint16_t>(at + 1);
    tracker.stations = {station};
    setup.trackers.push_back({test.inputs[at].side, station, tracker});
  }
  setup.loop = recording::LoopSetup{"ball.obj", recording::sum_of(test.model.vertices),
                                    test.placement, test.options, "AVX2"};
  setup.loop->is_tracked = !setup.trackers.empty();
  if (test.options.rig) {
    setup.loop->puppet.text = test.options.rig->puppet().text;
    setup.loop->puppet.starts = test.options.rig->starts();
  }
  return setup;
}

/// A loop of two hands with a recorder at its input log.
struct RecordedLoop {
  TemporaryFolder folder;
  std::filesystem::path path = folder.path() / "take.nendo";
  flow::InputLog input_log;
  LoopUnderTest test;
  recording::Setup setup;
  std::unique_ptr<recording::Recorder> recorder;
  recording::Recorder* other = nullptr; ///< to which the loop's log goes, if not to `recorder`
  std::vector<std::string> warnings;    ///< by the recorder's thread; read it after end()

  explicit RecordedLoop(flow::Mode mode, hand::FilterKind filter = hand::FilterKind::off,
                        bool adapts = false, bool injective = false,
                        flow::SwitchAction action = flow::SwitchAction::none,
                        const char* puppet = nullptr, bool slips = false, bool tracked = false)
      : test(mode,
             {.rings_of_ball = 16,
              .switch_action = action,
              .filter = filter,
              .close_pinches = filter == hand::FilterKind::one_euro,
              .adapt = adapts ? std::optional(CountScale{}) : std::nullopt,
              .slips = slips,
              .input_log = &input_log,
              .injective = injective ? std::optional(deform::InjectiveOptions{}) : std::nullopt,
              .puppet = puppet,
              .tracked = tracked}),
        setup(setup_of(test)) {}

  void record(recording::RecorderOptions options = {}) {
    if (options.file.empty() && options.keep_last == HostClock::duration::zero())
      options.file = path;
    options.report = [this](std::string_view line) { warnings.emplace_back(line); };
    auto begun = recording::Recorder::begin(setup, input_log, std::move(options));
    if (!begun) throw std::runtime_error(begun.error().message);
    recorder = *std::move(begun);
  }
  /// As who runs the loop does. Returns false if it is refused.
  bool change_puppet(const std::shared_ptr<const puppet::Rig>& rig) {
    recording::Recorder* const tells = other != nullptr ? other : recorder.get();
    if (tells != nullptr)
      tells->add_puppet(test.loop->changes().next_puppet(), {rig->puppet().text, rig->starts()});
    return bool(test.loop->changes().change_puppet(rig));
  }
  Result<recording::Recorded> end() {
    return recorder->end(recording::sum_of(test.loop->final_shape()));
  }
};

/// Of how a puppet is played: who releases, who grabs, what listens to what.
template <class Random>
flow::Command any_role(Random& random) {
  const Side side = random() % 2 == 0 ? Side::left : Side::right;
  const auto number = static_cast<std::uint8_t>(random() % 43);
  if (random() % 3 == 0)
    return flow::SetRole{static_cast<std::uint16_t>(random() % 6),
                         *puppet::HandSignal::numbered(side, number)};
  if (random() % 2 == 0) return flow::SetSymmetry{random() % 2 == 0};
  const bool all = random() % 2 == 0;
  return flow::SetClutch{
      side, all ? puppet::RigPlayer::all_fingers : static_cast<std::uint8_t>(random() % 6),
      random() % 3 > 0};
}

/// Plays what people do: hands bend and move at random, requests are made, a switch is turned now
/// and then, and ticks find several samples or none. With `changes`, settings and models are
/// changed.
/// `see` is called with each frame.
template <class See>
void play(RecordedLoop& played, std::uint64_t ticks, unsigned seed, bool changes, See see) {
  std::mt19937 random(seed);
  std::mt19937 of_changes(seed + 1);
  LateMaker maker(seed + 2);
  flow::DeformLoop& loop = *played.test.loop;
  HostTime now = HostClock::now();
  int bent = 0;
  std::uint64_t sequence = 0;
  WristSwitch position = WristSwitch::off;
  for (std::uint64_t tick = 0; tick < ticks || !maker.is_idle(loop); ++tick) {
    for (auto samples = random() % 3; samples > 0; --samples, ++sequence) {
      bent = std::clamp(bent + static_cast<int>(random() % 5) - 2, 0, 30);
      now += std::chrono::milliseconds(11);
      if (random() % 40 == 0)
        position = position == WristSwitch::on ? WristSwitch::off : WristSwitch::on;
      for (const Side side : {Side::left, Side::right}) {
        GloveSample sample = bent_sample(side, side == Side::left ? bent : bent / 2, now);
        sample.wrist_switch = position;
        sample.sequence = sequence;
        played.test.rings[flow::Placement::index_of(side)]->try_push(sample);
      }
    }
    if (random() % 20 == 0)
      played.test.commands.try_push(flow::requests[random() % flow::requests.size()]);
    if (random() % 20 == 0) {
      const Side side = random() % 2 == 0 ? Side::left : Side::right;
      Eigen::Isometry3d wrist =
          played.test.placement.T_stage_wrist[flow::Placement::index_of(side)];
      wrist.translation().y() += 1e-3 * static_cast<double>(random() % 20);
      wrist.rotate(
          Eigen::AngleAxisd(1e-3 * static_cast<double>(random() % 20), Eigen::Vector3d::UnitX()));
      played.test.commands.try_push(flow::WristMove::to(side, wrist));
    }
    if (played.test.options.rig && of_changes() % 12 == 0)
      played.test.commands.try_push(any_role(of_changes));
    if (changes && of_changes() % 10 == 0)
      static_cast<void>(
          loop.changes().change_settings(any_settings(loop.changes().settings(), of_changes)));
    if (changes && played.test.options.rig && of_changes() % 15 == 0)
      played.change_puppet(any_puppet(loop.changes().puppet(loop.changes().newest_puppet()),
                                      played.test.model, of_changes));
    if (changes && !played.test.options.rig && of_changes() % 15 == 0)
      if (const auto masks =
              any_masks(loop.changes().puppet(loop.changes().newest_puppet()), of_changes))
        played.change_puppet(masks);
    if (changes) maker.turn(loop);
    const flow::Frame& frame = played.test.frame_after_tick(tick);
    see(frame);
    if (frame.awaited)
      static_cast<void>(loop.changes().change_to(*frame.awaited)); // as who runs the loop does
  }
}
inline void play(RecordedLoop& played, std::uint64_t ticks, unsigned seed = 1) {
  play(played, ticks, seed, false, [](const flow::Frame&) {});
}

} // namespace nendo::test
