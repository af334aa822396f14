#include "export/gltf_model.hpp"

#include <doctest/doctest.h>

#include "export/chosen_frames.hpp"
#include "support/glb_reader.hpp"
#include "support/recorded_motion.hpp"

namespace gltf_model_test {

using namespace nendo;
using namespace nendo::exporting;
using nendo::test::Glb;
using nendo::test::Motion;
using nendo::test::RecordedMotion;

TEST_SUITE("gltf_model") {
  TEST_CASE("a weight times its target is the vector times the influence, to the last bit") {
    const RecordedMotion motion(Motion{.ticks = 20});
    const auto source = motion.frames();
    auto frames = ChosenFrames::make(*source, {});
    REQUIRE(frames);
    ControlMorphs morphs(source->layout(0));
    deform::Points vertices;
    for (auto more = frames->next(); more && *more; more = frames->next()) {
      frames->vertices(vertices);
      REQUIRE(morphs.add(frames->frame(), vertices));
    }
    GlbFile file("test");
    GltfModel model(source->model(0), file);
    const auto weights = model.add_control_targets(morphs, file);
    const auto targets = static_cast<Eigen::Index>(model.target_count());
    REQUIRE(targets > 10);
    model.add_to(file, GltfMaterials(source->model(0).look, file), 1.0, {});
    REQUIRE(file.write(motion.path("model.glb")));
    const Glb glb(test::file_bytes(motion.path("model.glb")));
    const auto& mesh = glb.json["meshes"][0];
    const auto vectors = morphs.vectors();
    const Eigen::Index width = 3 * morphs.influences().rows();
    const auto moments = static_cast<Eigen::Index>(vectors.size()) / width;
    REQUIRE(static_cast<Eigen::Index>(weights.size()) == moments * targets);
    double worst = 0.0;
    for (Eigen::Index target = 0; target < targets; ++target) {
      const auto at = static_cast<std::size_t>(target);
      // "control 3 -y"
      const std::string name = mesh["extras"]["targetNames"][at];
      const Eigen::Index control = std::stol(name.substr(8)) - 1;
      const auto axis = static_cast<Eigen::Index>(name.back() - 'x');
      const double sign = name[name.size() - 2] == '+' ? 1.0 : -1.0;
      const Eigen::MatrixXd way =
          glb.accessor(mesh["primitives"][0]["targets"][at]["POSITION"].get<std::size_t>());
      const Eigen::RowVectorXd influence = sign * morphs.influences().row(control).cast<double>();
      for (Eigen::Index moment = 0; moment < moments; ++moment) {
        const double vector = std::max(
            0.0,
            sign * static_cast<double>(
                       vectors[static_cast<std::size_t>(moment * width + 3 * control + axis)]));
        const auto weight =
            static_cast<double>(weights[static_cast<std::size_t>(moment * targets + target)]);
        // Products of two floats are exact in doubles.
        worst =
            std::max(worst, (weight * way.row(axis) - vector * influence).cwiseAbs().maxCoeff());
      }
    }
    CHECK(worst == 0.0);
  }
}

} // namespace gltf_model_test
