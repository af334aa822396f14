#include "session/run_session.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <fstream>
#include <optional>
#include <thread>

#include <doctest/doctest.h>

#include <nendo/deform/mesh_file.hpp>
#include <nendo/recording/loop_replay.hpp>

#include "session/loop_change.hpp"
#include "session/open_hands.hpp"
#include "support/temporary_folder.hpp"
#include "support/test_meshes.hpp"
#include "takes/recorded_model.hpp"

namespace run_session_test {

using namespace nendo;
using namespace nendo::gloves;
using namespace nendo::session;
using namespace nendo::takes;

namespace {

/// Sees to the pace itself.
class PacingObserver : public Observer {
public:
  bool sets_pace() const noexcept override { return true; }

protected:
  static void wait() { std::this_thread::sleep_for(std::chrono::milliseconds(2)); }
};

/// Has the loop made anew three times, in the other mode each time, after some frames.
class Renewer final : public PacingObserver {
public:
  void loop_begins(const LoopStart& start) override {
    begun.push_back(start.model.vertices);
    modes.push_back(start.placed.setup.options.sculptor.mode);
    wrists.push_back(start.placed.setup.placement.T_stage_wrist[0].matrix());
    layout_ = &start.placed.loop->layout();
    settings_ = settings_of(start.placed);
    frames_ = 0;
  }
  void update(const RunStatus& status, flow::CommandRing& commands) override {
    wait();
    if (!status.fresh) return;
    if (++frames_ == 1) {
      layout_->unpack(status.frame.shape, shape_);
      const double jump = (shape_ - begun.back()).colwise().norm().maxCoeff();
      const auto pause = HostClock::now() - left_at_;
      if (begun.size() > 1 && pause < std::chrono::milliseconds(250))
        most_jump = std::max(most_jump, jump);
    }
    if (frames_ < 40) return;
    if (begun.size() >= 4) {
      commands.try_push(flow::EndRun{});
      return;
    }
    flow::LoopSettings settings = settings_;
    settings.mode = settings.mode == flow::Mode::type1 ? flow::Mode::type2 : flow::Mode::type1;
    left_at_ = HostClock::now();
    commands.try_push(flow::ChangeSettings{settings});
    if (unrecorded) commands.try_push(flow::SetRecording{*unrecorded != begun.size()});
  }

  std::vector<deform::Points> begun;
  std::vector<flow::Mode> modes;
  std::vector<Eigen::Matrix4d> wrists;
  double most_jump = 0.0;                ///< of the shape over a pause of a quarter second or less
  std::optional<std::size_t> unrecorded; ///< this loop alone is not; nothing: none is

private:
  int frames_ = 0;
  flow::LoopSettings settings_;
  HostTime left_at_{};
  const deform::BlockLayout* layout_ = nullptr;
  deform::Points shape_;
};

/// What is asked for at the same time, one after another.
using Changes = std::vector<std::vector<flow::Command>>;

/// Asks for one change after another of loops that have run for a while, and moves a hand
/// meanwhile.
class Asker final : public Sink, public Observer {
public:
  explicit Asker(Changes wanted) : changes(std::move(wanted)) {}

  Result<void> begin(const LoopStart& start) override {
    const auto settings = settings_of(start.placed);
    if (refused && settings.kernel == *refused) return Error{Errc::failed, "not with this kernel"};
    begun.push_back(start.model.vertices);
    in_force.push_back(settings);
    recorded.push_back(start.placed.recorded);
    wrists.push_back(start.placed.setup.placement.T_stage_wrist[0].translation());
    frames_ = 0;
    return {};
  }
  void show(const flow::Frame&) noexcept override { ++frames_; }
  void update(const RunStatus&, flow::CommandRing& commands) override {
    if (move) commands.try_push(*std::exchange(move, std::nullopt));
    if (frames_ < least_frames || asked >= changes.size()) return;
    for (const auto& command : changes[asked])
      commands.try_push(command);
    ++asked;
    begun_then_ = begun.size();
  }
  /// Has asked for all, so long ago that it has it.
  bool is_content() const {
    return asked == changes.size() && begun.size() > begun_then_ && frames_ >= 60;
  }

  Changes changes;
  std::optional<deform::Wendland> refused;
  std::optional<flow::WristMove> move;
  int least_frames = 30;
  std::size_t asked = 0;
  std::vector<deform::Points> begun;
  std::vector<flow::LoopSettings> in_force;
  std::vector<bool> recorded;
  std::vector<Eigen::Vector3d> wrists;

private:
  std::size_t begun_then_ = 0; ///< when it asked last
  std::atomic<int> frames_{0};
};

/// Asks for the shape to be saved, and ends the run at once.
class Saver final : public PacingObserver {
public:
  void update(const RunStatus& status, flow::CommandRing& commands) override {
    wait();
    if (!status.fresh || ++frames_ < 60) return;
    commands.try_push(flow::SaveShape{});
    commands.try_push(flow::EndRun{});
  }
  void report(const std::string& message) override { reports.push_back(message); }

  std::vector<std::string> reports;

private:
  int frames_ = 0;
};

/// Ends a run when all have what they asked for.
class Ender final : public PacingObserver {
public:
  explicit Ender(std::vector<const Asker*> askers) : askers_(std::move(askers)) {}
  void update(const RunStatus&, flow::CommandRing& commands) override {
    wait();
    if (std::all_of(askers_.begin(), askers_.end(),
                    [](const Asker* asker) { return asker->is_content(); }))
      commands.try_push(flow::EndRun{});
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
};

constexpr flow::Command reset = flow::ResetModel{};
constexpr flow::Command record(bool on) {
  return flow::SetRecording{on};
}
constexpr flow::Command change(const flow::LoopSettings& settings) {
  return flow::ChangeSettings{settings};
}

constexpr flow::LoopSettings other_settings{
    flow::Mode::type2, deform::Wendland::c4, {0.1, 0.11, 0.12, 0.13, 0.14}};

struct ReplayedLoop {
  deform::Points begun, left;
};

ReplayedLoop replay(const std::filesystem::path& file) {
  auto take = recording::TakeReader::open(file);
  REQUIRE(take);
  REQUIRE(take->setup().loop);
  const auto model = recorded_model(*take->setup().loop);
  REQUIRE(model);
  auto again = recording::LoopReplay::make(take->setup(), *model);
  REQUIRE(again);
  while (const auto entry = take->next())
    (*again)->feed(*entry);
  CHECK((*again)->is_exact());
  return {model->vertices, (*again)->loop().final_shape()};
}

/// Watches as a window or as a browser does, until it has seen enough.
class Onlooker final : public PacingObserver {
public:
  explicit Onlooker(bool stays) : stays_(stays) {}
  void update(const RunStatus& status, flow::CommandRing& commands) override {
    wait();
    silent = status.frame.hands[0].silent;
    if (silent && !reports.empty() && ++frames_after > 50) commands.try_push(flow::EndRun{});
  }
  void report(const std::string& message) override { reports.push_back(message); }
  bool stays_open() const noexcept override { return stays_; }

  std::vector<std::string> reports;
  bool silent = false;
  int frames_after = 0; ///< after the end was told

private:
  bool stays_;
};

} // namespace

TEST_SUITE("run_session") {
  TEST_CASE(
      "a run of recordings ends with them, but not before whoever looks at a window says so") {
    Run run;
    run.options.recording.file = (run.folder.path() / "take.nendo").string();
    REQUIRE(run.options.recording.check(run.options.out, flow::SwitchAction::none));
    run.options.right.clear();
    run.options.duration_s = 0.5;
    auto sim = open_hands(run.options, run.mesh, run.event_count);
    REQUIRE(sim);
    const RunParticipants alone{[](const auto&, double) {}};
    const auto recorded = run_session(run.options, sim->hands, run.mesh, alone);
    REQUIRE((recorded && recorded->recordings.front().recorded));
    const std::uint64_t samples = recorded->recordings.front().recorded->samples;

    Run again;
    again.options.left = "replay:" + run.options.recording.file;
    again.options.right.clear();
    for (const bool stays : {false, true}) {
      CAPTURE(stays);
      auto replayed = open_hands(again.options, again.mesh, again.event_count);
      REQUIRE(replayed);
      Onlooker onlooker(stays);
      const auto outcome = run_session(again.options, replayed->hands, again.mesh,
                                       {[](const auto&, double) {}, {&onlooker}});
      REQUIRE(outcome);
      CHECK(outcome->stats.samples[0] == samples - 1); // the first one placed the hand
      CHECK(onlooker.reports.size() == (stays ? 1 : 0));
      CHECK((onlooker.frames_after > 50) == stays);
    }
  }

  TEST_CASE("a loop that is made anew goes on from the shape as it was, with the hands where they "
            "were, and what was shaped is in the file") {
    const test::TemporaryFolder folder;
    const auto mesh = test::sphere(24, 48, 1.0);
    RunOptions options;
    options.left = options.right = "sim:sculpt";
    options.mesh = "ball";
    options.out = (folder.path() / "out.ply").string();
    EventCount event_count;
    auto opened = open_hands(options, mesh, event_count);
    REQUIRE(opened);
    Renewer renewer;
    const auto outcome =
        run_session(options, opened->hands, mesh, {[](const auto&, double) {}, {&renewer}});
    REQUIRE(outcome);
    REQUIRE(renewer.begun.size() == 4);
    CHECK(renewer.begun[0] == mesh.vertices);
    for (std::size_t at = 0; at < 3; ++at) {
      CHECK(renewer.begun[at + 1] != renewer.begun[at]); // something was shaped
      CHECK(renewer.wrists[at + 1] == renewer.wrists[0]);
      CHECK(renewer.modes[at + 1] != renewer.modes[at]);
    }
    const auto written = deform::read_mesh(options.out);
    REQUIRE(written);
    CHECK((written->vertices - mesh.vertices).cwiseAbs().maxCoeff() > 1e-3);
    // The hands go on moving meanwhile, by less than a simulated one does in a quarter second.
    CHECK(renewer.most_jump < 0.15);
  }

  TEST_CASE("what is to be saved just before the end is saved, and who asked hears where") {
    Run run;
    auto opened = open_hands(run.options, run.mesh, run.event_count);
    REQUIRE(opened);
    Saver saver;
    REQUIRE(
        run_session(run.options, opened->hands, run.mesh, {[](const auto&, double) {}, {&saver}}));
    const auto saved = run.folder.path() / "out-1.ply";
    CHECK(saver.reports == std::vector{"saved as " + saved.string()});
    const auto kept = deform::read_mesh(saved);
    const auto last = deform::read_mesh(run.options.out);
    REQUIRE((kept && last));
    CHECK(kept->vertices.cols() == run.mesh.vertices.cols());
    CHECK((kept->vertices - last->vertices).cwiseAbs().maxCoeff() < 0.15); // a tick or two
    CHECK((kept->vertices - run.mesh.vertices).cwiseAbs().maxCoeff() > 1e-4);
  }

  TEST_CASE("each loop that is recorded is a recording of its own, which replays by itself") {
    const test::TemporaryFolder folder;
    const auto mesh = test::sphere(24, 48, 1.0);
    RunOptions options;
    options.left = options.right = "sim:sculpt";
    options.mesh = (folder.path() / "ball.obj").string();
    REQUIRE(deform::write_mesh(options.mesh, mesh));
    options.out = (folder.path() / "out.ply").string();
    options.recording.file = (folder.path() / "take.nendo").string();
    REQUIRE(options.recording.check(options.out, flow::SwitchAction::none));
    const auto taken = folder.path() / "take-2.nendo"; // somebody else's
    std::ofstream(taken) << "kept";
    std::ofstream(folder.path() / "take.model.obj") << "of a take that is gone";
    EventCount event_count;
    auto opened = open_hands(options, mesh, event_count);
    REQUIRE(opened);
    Renewer renewer;
    renewer.unrecorded = 1;
    const auto outcome =
        run_session(options, opened->hands, mesh, {[](const auto&, double) {}, {&renewer}});
    REQUIRE(outcome);
    REQUIRE(outcome->recordings.size() == 3);
    CHECK(outcome->recordings[1].file == (folder.path() / "take-3.nendo").string());
    CHECK(std::filesystem::file_size(taken) == 4);
    const std::array<std::size_t, 3> loops{0, 2, 3};
    for (std::size_t at = 0; at < 3; ++at) {
      REQUIRE(outcome->recordings[at].recorded);
      CHECK(outcome->recordings[at].recorded->lost == 0);
      const auto replayed = replay(outcome->recordings[at].file);
      CHECK(replayed.begun == renewer.begun[loops[at]]);
      if (loops[at] < 3) CHECK(replayed.left == renewer.begun[loops[at] + 1]);
    }
  }

  TEST_CASE("what --adapt has learned goes on in the next loop, and stands in its recording") {
    Run run;
    run.options.left = run.options.right = "sim:grasp";
    run.options.calibration.adapt = true;
    Asker asker(Changes{{record(true)}, {change(other_settings)}});
    asker.least_frames = 270;
    const auto outcome = run.follow({&asker});
    REQUIRE(outcome.recordings.size() == 2);
    std::array<std::uint64_t, 2> turns{};
    for (std::size_t at = 0; at < turns.size(); ++at) {
      const auto& file = outcome.recordings[at].file;
      replay(file); // exactly
      const auto take = recording::TakeReader::open(file);
      REQUIRE(take);
      for (const auto& hand : take->setup().hands) {
        REQUIRE(hand.wearer.learned);
        CHECK(hand.wearer.learned->side == hand.side);
        for (const auto& sensor : hand.wearer.learned->sensors)
          turns[at] += std::uint64_t{sensor.bottoms} + sensor.tops;
      }
    }
    CHECK(turns[0] > 0);
    CHECK(turns[1] > turns[0]);
  }

  TEST_CASE("whoever watches a run has its settings changed, and only those that it names") {
    Run run;
    Asker asker(Changes{{change(other_settings)}, {reset}});
    const auto outcome = run.follow({&asker});
    CHECK(outcome.sculptor.mode == flow::Mode::type2); // which the summary tells
    CHECK(outcome.sculptor.deformer.csrbf.kernel == deform::Wendland::c4);
    REQUIRE(asker.begun.size() == 3);
    const auto& first = asker.in_force[0];
    const auto& second = asker.in_force[1];
    CHECK(first.mode == flow::Mode::type1);
    CHECK(second.mode == flow::Mode::type2);
    CHECK(second.kernel == deform::Wendland::c4);
    for (std::size_t finger = 0; finger < 5; ++finger)
      CHECK(second.radius_m[finger] == doctest::Approx(other_settings.radius_m[finger]));
    const double moved = (asker.begun[1] - asker.begun[0]).cwiseAbs().maxCoeff();
    CHECK(moved > 1e-4); // it goes on from what was shaped
    CHECK(asker.in_force[2] == second);
  }

  TEST_CASE(
      "a reset goes back to the model as it was loaded, to the last bit, with the radius that "
      "its size made") {
    Run run;
    Asker asker(Changes{{record(false)}, {record(true)}, {reset}});
    run.follow({&asker});
    REQUIRE(asker.begun.size() == 3); // one that records nothing already is no change
    CHECK(asker.begun[1] != run.mesh.vertices);
    CHECK(asker.begun[2] == run.mesh.vertices);
    CHECK(asker.in_force[1] == asker.in_force[0]); // though the model is another size now
    CHECK(asker.in_force[2] == asker.in_force[0]);
  }

  TEST_CASE(
      "recordings begin and end by an observer's command, each with a number, beside the shape") {
    Run run;
    Asker asker(Changes{{record(true)}, {record(false)}, {record(true)}});
    const auto outcome = run.follow({&asker});
    CHECK(asker.recorded == std::vector<bool>{false, true, false, true});
    REQUIRE(outcome.recordings.size() == 2);
    CHECK(outcome.recordings[0].file == (run.folder.path() / "out.nendo").string());
    CHECK(outcome.recordings[1].file == (run.folder.path() / "out-2.nendo").string());
    const auto replayed = replay(outcome.recordings[0].file);
    CHECK(replayed.begun == asker.begun[1]);
    CHECK(replayed.left == asker.begun[2]);
  }

  TEST_CASE("what several want in the same moment is one new loop") {
    Run run;
    Asker one(Changes{{change(other_settings)}});
    Asker other(Changes{{reset, record(true)}});
    one.least_frames = other.least_frames = 0; // that is before a new loop may be
    run.follow({&one, &other});
    REQUIRE(one.begun.size() == 2);
    CHECK(one.begun[1] == run.mesh.vertices);
    CHECK(one.in_force[1].mode == flow::Mode::type2);
    CHECK(one.recorded[1]);
  }

  TEST_CASE("who wants a new loop all the time has a few a second") {
    Run run;
    Asker asker(Changes(300, {reset}));
    asker.least_frames = 0;
    const HostTime start = HostClock::now();
    run.follow({&asker});
    const double elapsed_s = to_seconds(HostClock::now() - start);
    CHECK(asker.begun.size() >= 2);
    CHECK(static_cast<double>(asker.begun.size()) <= 2.0 + elapsed_s / 0.25);
  }

  TEST_CASE("a change with which no loop begins leaves the run as it was") {
    Run run;
    Asker asker(Changes{{change(other_settings)}, {reset}});
    asker.refused = deform::Wendland::c4;
    run.follow({&asker});
    REQUIRE(asker.begun.size() == 3);
    CHECK(asker.in_force[1] == asker.in_force[0]);
    CHECK(asker.begun[1] != run.mesh.vertices); // what was shaped is there
    CHECK(asker.begun[2] == run.mesh.vertices); // and it goes on hearing
  }

  TEST_CASE("an observer moves a hand, which stays there in the next loop") {
    Run run;
    Asker asker(Changes{{reset}});
    asker.move = flow::WristMove{Side::left, {-0.5, 0.25, 0.125}, {0, 0, 0, 1}};
    run.follow({&asker});
    REQUIRE(asker.wrists.size() == 2);
    CHECK(asker.wrists[1] == Eigen::Vector3d(-0.5, 0.25, 0.125));
    CHECK(asker.wrists[0] != asker.wrists[1]);
  }
}

} // namespace run_session_test
