#include "session/run_session.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <filesystem>
#include <fstream>
#include <thread>
#include <utility>

#include <doctest/doctest.h>

#include <nendo/deform/mesh_file.hpp>
#include <nendo/puppet/puppet_edit.hpp>
#include <nendo/recording/take_tools.hpp>

#include "session/asking_run.hpp"
#include "session/run_saving.hpp"
#include "support/flow_fixtures.hpp"

namespace run_session_test {

using namespace nendo;
using namespace nendo::gloves;
using namespace nendo::session;
using namespace nendo::takes;
using namespace nendo::session::asking;

namespace {

/// Saves the shape of hands that have released it under a name, and again without one.
class Namer final : public PacingObserver {
public:
  Namer(std::string file, bool is_settled) : file_(std::move(file)), is_settled_(is_settled) {}
  void update(const RunStatus& status, Asks& asks) override {
    if (!status.fresh) return;
    was_modified = was_modified || status.saving->is_modified(status.frame);
    if (step_ == 0 && status.saving->is_modified(status.frame)) {
      asks.emplace_back(flow::Request::release);
      step_ = 1;
    } else if (step_ == 1 && !status.frame.held) {
      asks.emplace_back(SaveShapeAs{file_});
      step_ = 2;
    } else if (step_ == 2 && status.saving->saves() == 1) {
      was_clean = !status.saving->is_modified(status.frame) && status.saving->saved() == file_;
      asks.emplace_back(flow::SaveShape{});
      step_ = 3;
    } else if (step_ == 3 && status.saving->saves() == 2) {
      asks.emplace_back(flow::EndRun{});
    }
  }
  void report(const Report& message) override { reports.push_back(message.text); }
  bool has_settled_shape() const noexcept override { return is_settled_; }

  std::vector<std::string> reports;
  bool was_modified = false, was_clean = false;

private:
  std::string file_;
  bool is_settled_;
  int step_ = 0;
};

/// Asks for the shape to be saved, and ends the run at once.
class Saver final : public PacingObserver {
public:
  void update(const RunStatus& status, Asks& asks) override {
    wait();
    if (!status.fresh || ++frames_ < 60) return;
    asks.emplace_back(flow::SaveShape{});
    asks.emplace_back(flow::EndRun{});
  }
  void report(const Report& message) override { reports.push_back(message.text); }

  std::vector<std::string> reports;

private:
  int frames_ = 0;
};

/// Watches as a window or as a browser does, until it has seen enough.
class Onlooker final : public PacingObserver {
public:
  explicit Onlooker(bool stays) : stays_(stays) {}
  void update(const RunStatus& status, Asks& asks) override {
    wait();
    silent = status.frame.hands[0].silent;
    if (silent && !reports.empty() && ++frames_after > 50) asks.emplace_back(flow::EndRun{});
  }
  void report(const Report& message) override { reports.push_back(message.text); }
  bool stays_open() const noexcept override { return stays_; }

  std::vector<std::string> reports;
  bool silent = false;
  int frames_after = 0; ///< after the end was reported

private:
  bool stays_;
};

/// Takes half a second to get ready, and ends the run when it has seen samples of both hands.
class Slow final : public Sink, public PacingObserver {
public:
  Result<void> begin(const LoopStart&) override { return {}; }
  Result<void> prepare(const flow::ModelVersion&) override { return {}; }
  Result<void> settle() override { return {}; }
  void loop_begins(const LoopStart&) override {
    std::this_thread::sleep_for(std::chrono::milliseconds(500));
  }
  void show(const flow::Frame& frame) noexcept override {
    if (frame.ticks_run == 1) waiting = frame.hands[0].samples;
  }
  void update(const RunStatus& status, Asks& asks) override {
    wait();
    if (status.frame.hands[0].samples > 0 && status.frame.hands[1].samples > 0)
      asks.emplace_back(flow::EndRun{});
  }

  std::atomic<std::uint64_t> waiting{1000}; ///< samples of the left hand, for the first tick
};

/// Makes a puppet, edits it twice, undoes the last edit, and ends the run.
class PuppetMaker final : public PacingObserver {
public:
  explicit PuppetMaker(const deform::Mesh& mesh) : mesh_(mesh) {}
  void update(const RunStatus& status, Asks& asks) override {
    wait();
    if (!status.fresh || ++frames_ % 25 != 0) return;
    const std::size_t step = frames_ / 25;
    if (step == 1) make(puppet::parse_puppet(test::ball_puppet, "a test's puppet"), asks);
    if (step == 2) make(puppet::with_radius(*status.puppet, 0, 0.6), asks);
    if (step == 3)
      make(puppet::with_function(*status.puppet, {{0, 1, 0}, 0.5}, {0, 0.3, 0},
                                 *puppet::HandSignal::named("left.index_flexion"), 0.5),
           asks);
    if (step == 4) {
      asks.emplace_back(flow::Request::release);
      asks.emplace_back(flow::Request::undo);
    }
    if (step == 6) asks.emplace_back(flow::EndRun{});
  }
  void report(const Report& message) override { FAIL(message.text); }

private:
  void make(const Result<puppet::Puppet>& puppet, Asks& asks) const {
    REQUIRE(puppet);
    asks.emplace_back(std::make_shared<const puppet::Rig>(*puppet, mesh_));
  }

  const deform::Mesh& mesh_;
  std::size_t frames_ = 0;
};

} // namespace

TEST_SUITE("run_session") {
  TEST_CASE("a take whose puppet was edited on the way is played over with all its puppets") {
    Run run;
    run.options.left = run.options.right = "sim:faces";
    const auto file = [&](const char* name) { return (run.folder.path() / name).string(); };
    run.options.recording.file = file("take.nendo");
    REQUIRE(run.options.recording.check(run.options.out, flow::SwitchAction::none));
    {
      auto opened = open_hands(run.options, run.mesh, run.event_count);
      REQUIRE(opened);
      PuppetMaker maker(run.mesh);
      RunParticipants participants{[](const auto&, double) {}};
      participants.observers.push_back(&maker);
      REQUIRE(run_session(run.options, opened->hands, run.mesh, participants));
    }
    replay(file("take.nendo"));
    const auto before = recording::summarise(file("take.nendo"));
    REQUIRE(before);
    CHECK(before->puppet_changes >= 4);

    auto opened = run.open_over(file("take.nendo"), file("over.nendo"));
    CHECK(run.options.over->take.puppets.size() >= 3);
    Asker asker({}); // a sink, whose space the puppets must fit
    const RunParticipants participants{[](const auto&, double) {}, {&asker}, {}};
    REQUIRE(run_session(run.options, opened->hands, run.mesh, participants));
    replay(file("over.nendo"));
    const auto after = recording::summarise(file("over.nendo"));
    REQUIRE(after);
    CHECK(after->is_whole());
    CHECK(after->puppet_changes == before->puppet_changes);
    CHECK(after->requests == before->requests);
  }

  TEST_CASE("a take that is played over does again what people asked of it, and is punched") {
    Run run;
    const auto file = [&](const char* name) { return (run.folder.path() / name).string(); };
    run.options.recording.file = file("take.nendo");
    REQUIRE(run.options.recording.check(run.options.out, flow::SwitchAction::none));
    auto others = other_settings;
    others.kernel = deform::Wendland::c0;
    Asker asker({{change(other_settings)},
                 {flow::Subdivide{}},
                 {reset},
                 {flow::Mark{}},
                 {},
                 {change(others)},
                 {}});
    run.follow({&asker});
    const auto changes = replay(file("take.nendo"));
    const auto before = recording::summarise(file("take.nendo"));
    REQUIRE(before);
    CHECK(changes >= 2);
    CHECK(before->model_changes == 1);

    auto opened = run.open_over(file("take.nendo"), file("over.nendo"));
    CHECK(opened->hands.size() == 1);
    Asker puncher({{flow::Punch{}}, {flow::Punch{}}});
    const RunParticipants participants{[](const auto&, double) {}, {&puncher}, {&puncher}};
    REQUIRE(run_session(run.options, opened->hands, run.mesh, participants));
    for (const char* shown : {"punched out", "punched in"})
      CHECK(std::count(puncher.reports.begin(), puncher.reports.end(), shown) == 1);
    CHECK(replay(file("over.nendo")) == changes);
    const auto after = recording::summarise(file("over.nendo"));
    REQUIRE(after);
    CHECK(after->is_whole());
    CHECK(after->setup.gloves.size() == 3);
    CHECK(after->model_changes == before->model_changes);
    CHECK(after->requests == before->requests);
    CHECK(after->marks.size() == 1);
  }

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
      CHECK(outcome->stats.samples[0] == samples);
      CHECK(onlooker.reports.size() == (stays ? 1 : 0));
      CHECK((onlooker.frames_after > 50) == stays);
    }
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

  TEST_CASE("a shape is saved under a chosen name again and again, and then is not modified") {
    Run run;
    const auto chosen = (run.folder.path() / "chosen.ply").string();
    for (const bool is_settled : {true, false}) {
      CAPTURE(is_settled);
      std::filesystem::remove(run.options.out);
      auto opened = open_hands(run.options, run.mesh, run.event_count);
      REQUIRE(opened);
      Namer namer(chosen, is_settled);
      const auto outcome =
          run_session(run.options, opened->hands, run.mesh, {[](const auto&, double) {}, {&namer}});
      REQUIRE(outcome);
      CHECK(namer.reports == std::vector(2, "saved as " + chosen));
      CHECK(namer.was_modified); // by the hands, before
      CHECK(namer.was_clean);    // after the hands had released the shape, and it was saved
      CHECK(deform::read_mesh(chosen));
      CHECK(std::filesystem::exists(run.options.out) == !is_settled);
      CHECK(outcome->result == (is_settled ? chosen : run.options.out));
    }
  }

  TEST_CASE(
      "settings change while one loop runs, and a recording of all of it ends with its shape") {
    Run run;
    run.options.left = run.options.right = "sim:grasp"; // moves after the last undo, too
    run.options.recording.file = (run.folder.path() / "take.nendo").string();
    REQUIRE(run.options.recording.check(run.options.out, flow::SwitchAction::none));
    flow::LoopSettings smaller = other_settings;
    smaller.radius_m.fill(0.08);
    flow::LoopSettings back = smaller;
    back.mode = flow::Mode::type1;
    back.filter.kind = hand::FilterKind::one_euro;
    Asker asker(Changes{{change(other_settings)},
                        {change(smaller)},
                        {reset},
                        {change(back)},
                        {flow::Request::undo},
                        {change(back)}}); // which is in effect already
    const auto outcome = run.follow({&asker});
    CHECK(asker.begun == 1);
    CHECK(asker.leaps == 0);
    REQUIRE(asker.settings.size() == 4);
    CHECK(asker.settings[1] == other_settings);
    CHECK(asker.settings[2] == smaller);
    CHECK(asker.settings[3] == back);
    CHECK(outcome.stats.changes == 3);
    CHECK(outcome.stats.resets == 1);
    CHECK(outcome.sculptor.mode == flow::Mode::type1); // which the summary reports
    CHECK(outcome.sculptor.deformer.csrbf.kernel == deform::Wendland::c4);
    REQUIRE(outcome.recordings.size() == 1);
    CHECK(replay(outcome.recordings[0].file) == 3);
    const auto written = deform::read_mesh(run.options.out);
    REQUIRE(written);
    CHECK((written->vertices - run.mesh.vertices).cwiseAbs().maxCoeff() > 1e-3);
  }

  TEST_CASE("a mark is in the recording, and without one the reason is reported") {
    Run run;
    Asker asker(Changes{{flow::Mark{}}, {record(true)}, {flow::Mark{}}, {flow::Mark{}}});
    asker.min_ticks = 60;
    const auto outcome = run.follow({&asker});
    const auto shown = [&](const char* words) {
      return std::count(asker.reports.begin(), asker.reports.end(), words);
    };
    CHECK(shown("There is no recording to mark; begin one with t.") == 1);
    CHECK(shown("mark 1 is in the recording") == 1);
    CHECK(shown("mark 2 is in the recording") == 1);
    REQUIRE(outcome.recordings.size() == 1);
    const auto summary = recording::summarise(outcome.recordings[0].file);
    REQUIRE(summary);
    CHECK(summary->marks.size() == 2);
  }

  TEST_CASE(
      "recordings begin and end by command while the loop runs, each with a number, beside the "
      "shape, and each ends with the shape of its last tick") {
    Run run;
    run.options.calibration.adapt = true; // what it has learned stands in each recording
    const auto taken = run.folder.path() / "out-2.nendo"; // somebody else's
    std::ofstream(taken) << "kept";
    Asker asker(Changes{{record(true)},
                        {record(true)}, // which is so already
                        {change(other_settings)},
                        {record(false)},
                        {reset},
                        {record(true)}});
    asker.min_ticks = 60;
    const auto outcome = run.follow({&asker});
    CHECK(asker.begun == 1);
    CHECK(asker.leaps == 0);
    CHECK(asker.recorded == std::vector<bool>{false, true, false, true});
    REQUIRE(outcome.recordings.size() == 2);
    CHECK(outcome.recordings[0].file == (run.folder.path() / "out.nendo").string());
    CHECK(outcome.recordings[1].file == (run.folder.path() / "out-3.nendo").string());
    CHECK(std::filesystem::file_size(taken) == 4);
    CHECK(replay(outcome.recordings[0].file) == 1);
    CHECK(replay(outcome.recordings[1].file) == 0);
    for (const RecordingOutcome& recording : outcome.recordings) {
      REQUIRE(recording.recorded);
      CHECK(recording.recorded->lost == 0);
      CHECK(recording.recorded->samples > 0);
      std::uint64_t delivered = 0;
      for (const auto& counts : recording.recorded->sent) {
        CHECK(counts.delivered > 0);
        delivered += counts.delivered;
      }
      CHECK(delivered >= recording.recorded->samples);
      const auto take = recording::TakeReader::open(recording.file);
      REQUIRE(take);
      for (const auto& hand : take->setup().hands)
        CHECK(hand.wearer.learned);
    }
  }

  TEST_CASE("what simulated hands do begins with the loop, however long it takes to get ready") {
    Run run;
    Slow slow;
    auto opened = open_hands(run.options, run.mesh, run.event_count);
    REQUIRE(opened);
    REQUIRE(run_session(run.options, opened->hands, run.mesh,
                        {[](const auto&, double) {}, {&slow}, {&slow}}));
    CHECK(slow.waiting < 25); // of some 45 that would have come in half a second
  }

  TEST_CASE("what is kept in memory continues in the next recording, and can be kept as a file") {
    Run run;
    run.options.recording.keep_last = "60s";
    REQUIRE(run.options.recording.check(run.options.out, flow::SwitchAction::none));
    Asker asker(Changes{
        {record(true)}, {change(other_settings)}, {record(false)}, {flow::SaveRecording{}}});
    const auto outcome = run.follow({&asker});
    REQUIRE(outcome.recordings.size() == 3);
    CHECK(outcome.recordings[0].file.empty());
    replay(outcome.recordings[1].file);
    REQUIRE(outcome.recordings[2].recorded);
    CHECK(outcome.recordings[2].recorded->kept == 1);
    auto kept = recording::TakeReader::open(run.folder.path() / "out.kept-1.nendo");
    REQUIRE(kept);
    REQUIRE(kept->setup().loop);
    CHECK(kept->setup().loop->options.sculptor.mode == flow::Mode::type2);
    CHECK_FALSE(kept->setup().loop->rest.empty());
  }

  TEST_CASE("a recording that cannot be begun is reported, and the run continues without it") {
    Run run;
    run.options.recording.file = "/nowhere/at/all.nendo"; // as if its folder had gone
    Asker asker(Changes{{record(true)}, {change(other_settings)}});
    const auto outcome = run.follow({&asker});
    REQUIRE(asker.reports.size() == 1);
    CHECK(asker.reports[0].find("/nowhere/at/all.nendo") != std::string::npos);
    CHECK(asker.reports[0].find("the run continues") != std::string::npos);
    CHECK(outcome.recordings.empty());
    CHECK(outcome.stats.changes == 1);
    CHECK(asker.leaps == 0);
  }

  TEST_CASE("what several want in the same moment is done in one tick") {
    Run run;
    Asker one(Changes{{change(other_settings)}});
    Asker other(Changes{{reset, record(true)}});
    const auto outcome = run.follow({&one, &other});
    CHECK(outcome.stats.changes == 1);
    CHECK(outcome.stats.resets == 1);
    REQUIRE(outcome.recordings.size() == 1);
    replay(outcome.recordings[0].file);
  }

  TEST_CASE("a brush whose size changes at each picture costs no tick") {
    Run run;
    Changes changes;
    for (int at = 0; at < 200; ++at) {
      flow::LoopSettings settings = other_settings;
      settings.radius_m.fill(0.05 + 0.001 * at);
      changes.push_back({change(settings)});
    }
    changes.insert(changes.end(), 30, {}); // so that the last is seen
    Asker asker(changes);
    asker.min_ticks = 1;
    const auto outcome = run.follow({&asker});
    CHECK(outcome.stats.changes > 50); // the newest counts, when the loop has the one before
    CHECK(asker.leaps == 0);
    CHECK(asker.settings.back().radius_m[0] == doctest::Approx(0.249));
  }

  TEST_CASE("settings that nothing can be done with are reported, and the run continues") {
    Run run;
    flow::LoopSettings wrong = other_settings;
    wrong.radius_m[2] = -1.0;
    Asker asker(Changes{{change(wrong)}, {change(other_settings)}});
    const auto outcome = run.follow({&asker});
    CHECK(asker.reports.size() == 1);
    REQUIRE(asker.settings.size() == 2);
    CHECK(asker.settings[1] == other_settings);
    CHECK(outcome.stats.changes == 1);
  }

  TEST_CASE("a setting that has no effect beside another is taken, and that is said once") {
    Run run;
    flow::LoopSettings both = other_settings;
    both.keep_volume = 0.5;
    flow::LoopSettings smaller = both;
    smaller.radius_m.fill(0.08);
    Asker asker(Changes{{change(both)}, {change(smaller)}});
    run.follow({&asker});
    REQUIRE(asker.reports.size() == 1);
    CHECK(asker.reports[0].find("never folding") != std::string::npos);
    REQUIRE(asker.settings.size() == 3);
    CHECK(asker.settings[2] == smaller);
  }

  TEST_CASE("an observer moves a hand, which stays there through changes and recordings") {
    Run run;
    Asker asker(Changes{{flow::WristMove{Side::left, {-0.5, 0.25, 0.125}, {0, 0, 0, 1}}},
                        {change(other_settings)},
                        {record(true)}});
    const auto outcome = run.follow({&asker});
    CHECK(asker.wrist == Eigen::Vector3d(-0.5, 0.25, 0.125));
    REQUIRE(outcome.recordings.size() == 1);
    const auto take = recording::TakeReader::open(outcome.recordings[0].file);
    REQUIRE(take);
    CHECK(take->setup().loop->placement.T_stage_wrist[0].translation() == asker.wrist);
  }

  TEST_CASE("a hand that cannot be moved there stays, and the reason is said once") {
    Run run;
    const flow::WristMove too_far{Side::left, {-0.5, 4000.0, 0.0}, {0, 0, 0, 1}};
    const flow::WristMove near{Side::left, {-0.5, 0.25, 0.125}, {0, 0, 0, 1}};
    Asker asker(Changes{{near}, {too_far}, {too_far}});
    run.follow({&asker});
    CHECK(asker.wrist == Eigen::Vector3d(-0.5, 0.25, 0.125));
    REQUIRE(asker.reports.size() == 1);
    CHECK(asker.reports[0].find("within 100 m of the stage's middle") != std::string::npos);
  }
}

} // namespace run_session_test
