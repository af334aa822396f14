#pragma once
// A run of simulated hands, and who asks for something in it.

#include <algorithm>
#include <atomic>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include <nendo/deform/mesh_file.hpp>
#include <nendo/recording/loop_replay.hpp>
#include <nendo/recording/take_reader.hpp>

#include "session/open_hands.hpp"
#include "session/overdub.hpp"
#include "session/run_session.hpp"
#include "support/temporary_folder.hpp"
#include "support/test_meshes.hpp"
#include "takes/model_files.hpp"

namespace nendo::session::asking {

/// Sees to the pace itself.
class PacingObserver : public Observer {
public:
  bool sets_pace() const noexcept override { return true; }

protected:
  static void wait() { std::this_thread::sleep_for(std::chrono::milliseconds(2)); }
};

/// What is asked for at the same time, one after another.
using Changes = std::vector<std::vector<flow::Command>>;

/// Asks for one change after another when the run has continued for some frames, and then for its
/// end. It is shown each frame in the tick.
class Asker final : public Sink, public Observer {
public:
  explicit Asker(Changes wanted) : changes(std::move(wanted)) {}

  Result<void> begin(const LoopStart&) override { return {}; }
  Result<void> prepare(const flow::ModelVersion& version) override {
    if (refuses) return Error{Errc::failed, "no other model here"};
    prepared.push_back(version.number);
    return {};
  }
  Result<void> settle() override {
    ++settled;
    return {};
  }
  void loop_begins(const LoopStart&) override { ++begun; }
  void show(const flow::Frame& frame) noexcept override {
    if (frame.ticks_run != ticks_ + 1) ++leaps; // another loop, or a tick that nobody was shown
    ticks_ = frame.ticks_run;
  }
  void update(const RunStatus& status, Asks& asks) override {
    if (settings.empty() || settings.back() != status.frame.settings)
      settings.push_back(status.frame.settings);
    if (recorded.empty() || recorded.back() != status.facts.recorded)
      recorded.push_back(status.facts.recorded);
    wrist = status.frame.hands[0].T_stage_wrist.translation();
    CHECK(status.model.number == status.frame.model);
    status.model.layout().unpack(status.frame.shape, shape);
    if (ticks_ < asked_at_ + min_ticks) return;
    asked_at_ = ticks_;
    if (asked == changes.size()) content_ = true;
    if (content_) return;
    for (const auto& command : changes[asked])
      asks.emplace_back(command);
    ++asked;
  }
  void report(const Report& message) override { reports.push_back(message.text); }
  bool is_content() const { return content_; }

  Changes changes;
  std::uint64_t min_ticks = 30; ///< between two changes, and before the end
  std::size_t asked = 0;
  int begun = 0;
  std::atomic<int> leaps{0};
  std::vector<flow::LoopSettings> settings; ///< one after another
  std::vector<bool> recorded;               ///< to a file or not, one after another
  Eigen::Vector3d wrist;                    ///< the latest, of the left hand
  deform::Points shape;                     ///< the latest
  std::vector<std::string> reports;
  bool refuses = false;                ///< other models
  std::vector<std::uint32_t> prepared; ///< versions
  int settled = 0;

private:
  std::atomic<std::uint64_t> ticks_{0};
  std::uint64_t asked_at_ = 0;
  bool content_ = false;
};

/// Ends a run when all have what they asked for.
class Ender final : public PacingObserver {
public:
  explicit Ender(std::vector<const Asker*> askers) : askers_(std::move(askers)) {}
  void update(const RunStatus&, Asks& asks) override {
    wait();
    if (std::all_of(askers_.begin(), askers_.end(),
                    [](const Asker* asker) { return asker->is_content(); }))
      asks.emplace_back(flow::EndRun{});
  }

private:
  std::vector<const Asker*> askers_;
};

struct Run {
  test::TemporaryFolder folder;
  deform::Mesh mesh = test::sphere(24, 48, 1.0);
  RunOptions options;
  EventCount event_count;

  Run() {
    options.left = options.right = "sim:sculpt";
    options.mesh = (folder.path() / "ball.obj").string();
    REQUIRE(deform::write_mesh(options.mesh, mesh));
    options.out = (folder.path() / "out.ply").string();
    REQUIRE(options.recording.check(options.out, flow::SwitchAction::none));
  }
  RunOutcome follow(std::vector<Asker*> askers) {
    auto opened = open_hands(options, mesh, event_count);
    REQUIRE(opened);
    Ender ender({askers.begin(), askers.end()});
    RunParticipants participants{
        [](const auto&, double) {}, {askers.begin(), askers.end()}, {askers.begin(), askers.end()}};
    participants.observers.push_back(&ender);
    auto outcome = run_session(options, opened->hands, mesh, participants);
    REQUIRE(outcome);
    return *std::move(outcome);
  }
  /// Opens the left hand for a run over `take`, of which the left index finger is played again, and
  /// which is recorded to `file`.
  Result<RunHands> open_over(const std::string& take, const std::string& file) {
    const OverdubArguments arguments{take, "left.index", "", ""};
    auto over = read_overdub(arguments);
    REQUIRE(over);
    options.over = *over;
    options.right.clear();
    const auto live = live_part(arguments, options);
    REQUIRE(live);
    options.live = *live;
    REQUIRE(take_over_settings(mesh, options));
    options.recording = {};
    options.recording.file = file;
    REQUIRE(options.recording.check(options.out, flow::SwitchAction::none));
    auto opened = open_hands(options, mesh, event_count);
    REQUIRE(opened);
    return opened;
  }
};

inline constexpr flow::Command reset = flow::Request::reset;
constexpr flow::Command record(bool on) {
  return flow::SetRecording{on};
}
constexpr flow::Command change(const flow::LoopSettings& settings) {
  return flow::ChangeSettings{settings};
}

inline constexpr flow::LoopSettings other_settings{
    flow::Mode::type2, deform::Wendland::c4, true, {0.1, 0.11, 0.12, 0.13, 0.14}};

/// Replays a recording, which reports its last shape itself. Returns how often its settings
/// changed.
inline std::uint64_t replay(const std::filesystem::path& file) {
  auto take = recording::TakeReader::open(file);
  REQUIRE(take);
  REQUIRE(take->setup().loop);
  const auto model = takes::find_recorded_model(*take->setup().loop);
  REQUIRE(model);
  CHECK(model->is_recorded);
  auto again = recording::LoopReplay::make(take->setup(), model->mesh);
  REQUIRE(again);
  while (const auto entry = take->next())
    (*again)->feed(*entry);
  CHECK((*again)->is_exact());
  REQUIRE(take->ending());
  CHECK(take->ending()->shape == recording::sum_of((*again)->loop().final_shape()));
  return (*again)->loop().stats().changes;
}

} // namespace nendo::session::asking
