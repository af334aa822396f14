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

/// Has the loop made anew three times, in the other mode each time, after some frames.
class Renewer final : public Onlooker {
public:
  void begin(const PlacedLoop& placed, const deform::Mesh& model, const std::vector<OpenHand>&,
             const RunOptions&) override {
    begun.push_back(model.vertices);
    modes.push_back(placed.setup.options.sculptor.mode);
    wrists.push_back(placed.setup.placement.T_stage_wrist[0].matrix());
    settings_ = settings_of(placed);
    frames_ = 0;
  }
  Verdict look(flow::DeformLoop& loop, bool fresh) override {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
    if (!fresh) return Verdict::go_on;
    if (++frames_ == 1) {
      loop.layout().unpack(loop.frames().front().shape, shape_);
      const double jump = (shape_ - begun.back()).colwise().norm().maxCoeff();
      const auto pause = HostClock::now() - left_at_;
      if (begun.size() > 1 && pause < std::chrono::milliseconds(250))
        most_jump = std::max(most_jump, jump);
    }
    return frames_ < 40 || begun.size() < 4 ? Verdict::go_on : Verdict::end;
  }
  flow::LoopChange next_change() override {
    if (frames_ < 40) return {};
    flow::LoopSettings settings = settings_;
    settings.mode = settings.mode == flow::Mode::type1 ? flow::Mode::type2 : flow::Mode::type1;
    left_at_ = HostClock::now();
    return {settings, false, unrecorded && *unrecorded != begun.size()};
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
  deform::Points shape_;
};

using Changes = std::vector<flow::LoopChange>;

/// Wants one change after another of loops that have run for a while, and moves a hand meanwhile.
class Wisher final : public Outlet {
public:
  explicit Wisher(Changes wanted) : changes(std::move(wanted)) {}

  Result<void> begin(const PlacedLoop& placed, const deform::Mesh& model,
                     const std::vector<OpenHand>&) override {
    const auto settings = settings_of(placed);
    if (refused && settings.kernel == *refused) return Error{Errc::failed, "not with this kernel"};
    begun.push_back(model.vertices);
    in_force.push_back(settings);
    recorded.push_back(placed.recorded);
    wrists.push_back(placed.setup.placement.T_stage_wrist[0].translation());
    frames_ = 0;
    return {};
  }
  void show(const flow::Frame&) noexcept override { ++frames_; }
  std::optional<flow::WristMove> next_wrist() override { return std::exchange(move, std::nullopt); }
  flow::LoopChange next_change() override {
    if (frames_ < least_frames || asked >= changes.size()) return {};
    return changes[asked++];
  }
  /// Has asked for all, so long ago that it has it.
  bool is_content() const { return asked == changes.size() && frames_ >= 60; }

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
  std::atomic<int> frames_{0};
};

/// Wants the shape kept, and ends the run at once.
class Keeper final : public Onlooker {
public:
  void begin(const PlacedLoop&, const deform::Mesh&, const std::vector<OpenHand>&,
             const RunOptions&) override {}
  Verdict look(flow::DeformLoop&, bool fresh) override {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
    return fresh && ++frames_ >= 60 ? Verdict::end : Verdict::go_on;
  }
  flow::SaveRequest next_save_request() override { return {frames_ >= 60 && told.empty(), false}; }
  void tell(const std::string& words) override { told.push_back(words); }

  std::vector<std::string> told;

private:
  int frames_ = 0;
};

/// Ends a run when all have what they wanted.
class Ender final : public Onlooker {
public:
  explicit Ender(std::vector<const Wisher*> wishers) : wishers_(std::move(wishers)) {}
  void begin(const PlacedLoop&, const deform::Mesh&, const std::vector<OpenHand>&,
             const RunOptions&) override {}
  Verdict look(flow::DeformLoop&, bool) override {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
    const bool all = std::all_of(wishers_.begin(), wishers_.end(),
                                 [](const Wisher* wisher) { return wisher->is_content(); });
    return all ? Verdict::end : Verdict::go_on;
  }

private:
  std::vector<const Wisher*> wishers_;
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
  RunOutcome follow(std::vector<Wisher*> wishers) {
    auto hands = open_hands(options, mesh, event_count);
    REQUIRE(hands);
    Ender ender({wishers.begin(), wishers.end()});
    const Followers followers{[](const auto&, double) {}, &ender, {wishers.begin(), wishers.end()}};
    auto outcome = run_session(options, *hands, mesh, followers);
    REQUIRE(outcome);
    return *std::move(outcome);
  }
};

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

} // namespace

TEST_SUITE("run_session") {
  TEST_CASE("a loop that is made anew goes on from the shape as it was, with the hands where they "
            "were, and what was shaped is in the file") {
    const test::TemporaryFolder folder;
    const auto mesh = test::sphere(24, 48, 1.0);
    RunOptions options;
    options.left = options.right = "sim:sculpt";
    options.mesh = "ball";
    options.out = (folder.path() / "out.ply").string();
    EventCount event_count;
    auto hands = open_hands(options, mesh, event_count);
    REQUIRE(hands);
    Renewer renewer;
    const auto outcome = run_session(options, *hands, mesh, {[](const auto&, double) {}, &renewer});
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

  TEST_CASE("what is to be kept just before the end is kept, and who asked is told where") {
    Run run;
    auto hands = open_hands(run.options, run.mesh, run.event_count);
    REQUIRE(hands);
    Keeper keeper;
    REQUIRE(run_session(run.options, *hands, run.mesh, {[](const auto&, double) {}, &keeper}));
    const auto saved = run.folder.path() / "out-1.ply";
    CHECK(keeper.told == std::vector{"saved as " + saved.string()});
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
    auto hands = open_hands(options, mesh, event_count);
    REQUIRE(hands);
    Renewer renewer;
    renewer.unrecorded = 1;
    const auto outcome = run_session(options, *hands, mesh, {[](const auto&, double) {}, &renewer});
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
    Wisher wisher(Changes{{.record = true}, {.settings = other_settings}});
    wisher.least_frames = 270;
    const auto outcome = run.follow({&wisher});
    REQUIRE(outcome.recordings.size() == 2);
    std::array<std::uint64_t, 2> turns{};
    for (std::size_t at = 0; at < turns.size(); ++at) {
      const auto& file = outcome.recordings[at].file;
      replay(file); // exactly
      const auto take = recording::TakeReader::open(file);
      REQUIRE(take);
      for (const auto& hand : take->setup().hands) {
        REQUIRE(hand.learned);
        CHECK(hand.learned->side == hand.side);
        for (const auto& sensor : hand.learned->sensors)
          turns[at] += std::uint64_t{sensor.bottoms} + sensor.tops;
      }
    }
    CHECK(turns[0] > 0);
    CHECK(turns[1] > turns[0]);
  }

  TEST_CASE("whoever follows a run has its settings changed, and only those that it names") {
    Run run;
    Wisher wisher(Changes{{.settings = other_settings}, {.reset = true}});
    run.follow({&wisher});
    REQUIRE(wisher.begun.size() == 3);
    const auto& first = wisher.in_force[0];
    const auto& second = wisher.in_force[1];
    CHECK(first.mode == flow::Mode::type1);
    CHECK(second.mode == flow::Mode::type2);
    CHECK(second.kernel == deform::Wendland::c4);
    for (std::size_t finger = 0; finger < 5; ++finger)
      CHECK(second.radius_m[finger] == doctest::Approx(other_settings.radius_m[finger]));
    const double moved = (wisher.begun[1] - wisher.begun[0]).cwiseAbs().maxCoeff();
    CHECK(moved > 1e-4); // it goes on from what was shaped
    CHECK(wisher.in_force[2] == second);
  }

  TEST_CASE(
      "a reset goes back to the model as it was loaded, to the last bit, with the radius that "
      "its size made") {
    Run run;
    Wisher wisher(Changes{{.record = false}, {.record = true}, {.reset = true}});
    run.follow({&wisher});
    REQUIRE(wisher.begun.size() == 3); // one that records nothing already is no change
    CHECK(wisher.begun[1] != run.mesh.vertices);
    CHECK(wisher.begun[2] == run.mesh.vertices);
    CHECK(wisher.in_force[1] == wisher.in_force[0]); // though the model is another size now
    CHECK(wisher.in_force[2] == wisher.in_force[0]);
  }

  TEST_CASE("recordings begin and end by a follower's wish, each with a number, beside the shape") {
    Run run;
    Wisher wisher(Changes{{.record = true}, {.record = false}, {.record = true}});
    const auto outcome = run.follow({&wisher});
    CHECK(wisher.recorded == std::vector<bool>{false, true, false, true});
    REQUIRE(outcome.recordings.size() == 2);
    CHECK(outcome.recordings[0].file == (run.folder.path() / "out.nendo").string());
    CHECK(outcome.recordings[1].file == (run.folder.path() / "out-2.nendo").string());
    const auto replayed = replay(outcome.recordings[0].file);
    CHECK(replayed.begun == wisher.begun[1]);
    CHECK(replayed.left == wisher.begun[2]);
  }

  TEST_CASE("what several want in the same moment is one new loop") {
    Run run;
    Wisher one(Changes{{.settings = other_settings}});
    Wisher other(Changes{{.reset = true, .record = true}});
    one.least_frames = other.least_frames = 0; // that is before a new loop may be
    run.follow({&one, &other});
    REQUIRE(one.begun.size() == 2);
    CHECK(one.begun[1] == run.mesh.vertices);
    CHECK(one.in_force[1].mode == flow::Mode::type2);
    CHECK(one.recorded[1]);
  }

  TEST_CASE("who wants a new loop all the time has a few a second") {
    Run run;
    Wisher wisher(Changes(300, {.reset = true}));
    wisher.least_frames = 0;
    const HostTime start = HostClock::now();
    run.follow({&wisher});
    const double elapsed_s = to_seconds(HostClock::now() - start);
    CHECK(wisher.begun.size() >= 2);
    CHECK(static_cast<double>(wisher.begun.size()) <= 2.0 + elapsed_s / 0.25);
  }

  TEST_CASE("a change with which no loop begins leaves the run as it was") {
    Run run;
    Wisher wisher(Changes{{.settings = other_settings}, {.reset = true}});
    wisher.refused = deform::Wendland::c4;
    run.follow({&wisher});
    REQUIRE(wisher.begun.size() == 3);
    CHECK(wisher.in_force[1] == wisher.in_force[0]);
    CHECK(wisher.begun[1] != run.mesh.vertices); // what was shaped is there
    CHECK(wisher.begun[2] == run.mesh.vertices); // and it goes on hearing
  }

  TEST_CASE("a follower moves a hand, which stays there in the next loop") {
    Run run;
    Wisher wisher(Changes{{.reset = true}});
    wisher.move = flow::WristMove{Side::left, {-0.5, 0.25, 0.125}, {0, 0, 0, 1}};
    run.follow({&wisher});
    REQUIRE(wisher.wrists.size() == 2);
    CHECK(wisher.wrists[1] == Eigen::Vector3d(-0.5, 0.25, 0.125));
    CHECK(wisher.wrists[0] != wisher.wrists[1]);
  }
}

} // namespace run_session_test
