#include "run_session.hpp"

#include <array>
#include <fstream>
#include <optional>
#include <thread>

#include <doctest/doctest.h>

#include <nendo/deform/mesh_file.hpp>
#include <nendo/recording/loop_replay.hpp>

#include "open_hands.hpp"
#include "recorded_model.hpp"
#include "support/temporary_folder.hpp"
#include "support/test_meshes.hpp"

using namespace nendo;
using namespace nendo::app;

namespace {

/// Has the loop made anew three times, in the other mode each time, after some frames.
class Renewer final : public Onlooker {
public:
  void begin(const PlacedLoop& placed, const deform::Mesh& model, const std::vector<OpenHand>&,
             const RunOptions&) override {
    begun.push_back(model.vertices);
    modes.push_back(placed.setup.options.sculptor.mode);
    wrists.push_back(placed.setup.placement.T_stage_wrist[0].matrix());
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
    if (frames_ < 40) return Verdict::go_on;
    return begun.size() < 4 ? Verdict::renew : Verdict::end;
  }
  void change(RunOptions& options, deform::Mesh& model) override {
    options.recording.on = unrecorded && *unrecorded != begun.size();
    left.push_back(model.vertices);
    left_at_ = HostClock::now();
    auto& mode = options.loop.sculptor.mode;
    mode = mode == flow::Mode::type1 ? flow::Mode::type2 : flow::Mode::type1;
  }

  std::vector<deform::Points> begun, left;
  std::vector<flow::Mode> modes;
  std::vector<Eigen::Matrix4d> wrists;
  double most_jump = 0.0;                ///< of the shape over a pause of a quarter second or less
  std::optional<std::size_t> unrecorded; ///< this loop alone is not; nothing: none is

private:
  int frames_ = 0;
  HostTime left_at_{};
  deform::Points shape_;
};

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
    Bell bell;
    auto hands = open_hands(options, mesh, bell);
    REQUIRE(hands);
    Renewer renewer;
    const auto outcome = run_session(options, *hands, mesh, {[](const auto&, double) {}, &renewer});
    REQUIRE(outcome);
    REQUIRE(renewer.begun.size() == 4);
    CHECK(renewer.begun[0] == mesh.vertices);
    for (std::size_t at = 0; at < 3; ++at) {
      CHECK(renewer.begun[at + 1] == renewer.left[at]);
      CHECK(renewer.left[at] != renewer.begun[at]); // something was shaped
      CHECK(renewer.wrists[at + 1] == renewer.wrists[0]);
      CHECK(renewer.modes[at + 1] != renewer.modes[at]);
    }
    const auto written = deform::read_mesh(options.out);
    REQUIRE(written);
    CHECK((written->vertices - mesh.vertices).cwiseAbs().maxCoeff() > 1e-3);
    // The hands go on moving meanwhile, by less than a simulated one does in a quarter second.
    CHECK(renewer.most_jump < 0.15);
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
    Bell bell;
    auto hands = open_hands(options, mesh, bell);
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
      if (loops[at] < renewer.left.size()) CHECK(replayed.left == renewer.left[loops[at]]);
    }
  }

  TEST_CASE("a take that begins at a shape which was pulled about replays from there") {
    const test::TemporaryFolder folder;
    const auto mesh = test::sphere(24, 48, 1.0);
    RunOptions options;
    options.left = options.right = "sim:sculpt";
    options.mesh = (folder.path() / "ball.obj").string();
    REQUIRE(deform::write_mesh(options.mesh, mesh));
    options.out = (folder.path() / "out.ply").string();
    REQUIRE(options.recording.check(options.out, flow::SwitchAction::none));
    Bell bell;
    auto hands = open_hands(options, mesh, bell);
    REQUIRE(hands);
    Renewer renewer;
    renewer.unrecorded = 0; // and the first, for nothing asked for it
    const auto outcome = run_session(options, *hands, mesh, {[](const auto&, double) {}, &renewer});
    REQUIRE(outcome);
    REQUIRE(outcome->recordings.size() == 3);
    for (std::size_t at = 0; at < 3; ++at) {
      const auto replayed = replay(outcome->recordings[at].file);
      CHECK(replayed.begun == renewer.begun[at + 1]);
      CHECK(replayed.begun != mesh.vertices);
    }
  }
}
