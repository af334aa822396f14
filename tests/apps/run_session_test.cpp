#include "run_session.hpp"

#include <thread>

#include <doctest/doctest.h>

#include <nendo/deform/mesh_file.hpp>

#include "open_hands.hpp"
#include "support/temporary_folder.hpp"
#include "support/test_meshes.hpp"

using namespace nendo;
using namespace nendo::app;

namespace {

/// Has the loop made anew three times, in the other mode each time, after some frames.
class Renewer final : public Onlooker {
public:
  void begin(const PlacedLoop& placed, const deform::Mesh& model,
             const std::vector<OpenHand>&) override {
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
      if (begun.size() > 1) most_jump = std::max(most_jump, jump);
    }
    if (frames_ < 40) return Verdict::go_on;
    return begun.size() < 4 ? Verdict::renew : Verdict::end;
  }
  void change(RunOptions& options, deform::Mesh& model) override {
    left.push_back(model.vertices);
    auto& mode = options.loop.sculptor.mode;
    mode = mode == flow::Mode::type1 ? flow::Mode::type2 : flow::Mode::type1;
  }

  std::vector<deform::Points> begun, left;
  std::vector<flow::Mode> modes;
  std::vector<Eigen::Matrix4d> wrists;
  double most_jump = 0.0;

private:
  int frames_ = 0;
  deform::Points shape_;
};

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
    const auto outcome =
        run_session(options, *hands, mesh, {[](const auto&, double) {}, &renewer});
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
}
