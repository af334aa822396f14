// The hands of a run of nendo, in an application: the whole way from simulated gloves.

#include <algorithm>
#include <cmath>

#include <nendo_publish.h>

#include "openxr/application.hpp"
#include "support/eventually.hpp"
#include "support/mapped_file.hpp"
#include "support/program.hpp"

namespace openxr_program_test {

using namespace nendo::test;

TEST_SUITE("openxr_program") {
  TEST_CASE("an application has the hands of a run, and none after the run was killed") {
    const std::string name = WrittenSegment::unique_name("program");
    const TemporaryFolder folder;
    fresh_runtime();
    const LoaderEnvironment environment(name);
    Program run({"run", "--left", "sim:rest", "--right", "sim:grasp", "--duration", "120", "--out",
                 (folder.path() / "shape.obj").string(), "--to", "shm:" + name});
    const std::string path = "/dev/shm/nendo-" + name;
    REQUIRE(appears(path));
    const MappedFile segment(path);
    const auto newest = [&] { return nendo_publish_newest(segment.base()); };
    REQUIRE(eventually([&] { return newest() > 10; }));
    const InstanceInfo info(usual_extensions());
    OpenInstance instance(XR_NULL_HANDLE, xrGetInstanceProcAddr);
    REQUIRE(xrCreateInstance(info.get(), &instance.handle) == XR_SUCCESS);
    OpenSession session(instance);
    // At the place of the stage, joints are those of the record.
    const XrSpace stage = session.space(XR_REFERENCE_SPACE_TYPE_LOCAL,
                                        {{0.0F, 0.0F, 0.0F, 1.0F}, {0.0F, -0.4F, -0.6F}});
    for (std::size_t side = 0; side < 2; ++side) {
      const auto tracker = session.track(side == 0 ? XR_HAND_LEFT_EXT : XR_HAND_RIGHT_EXT);
      float far = 1.0F;
      CHECK(eventually([&] {
        nendo_publish_record record;
        if (!nendo_publish_read(segment.base(), newest(), &record, nullptr, 0)) return false;
        // At the time of that record nothing is extrapolated, unless a newer one came meanwhile.
        const LocatedHand hand = session.locate(tracker, stage, record.woke_ns);
        if (!hand.is_active || newest() != record.number) return false;
        far = 0.0F;
        for (std::size_t k = 0; k < 26; ++k) {
          const float* const p = record.hands[side].joints[k].position;
          const auto& at = hand.joints[k].pose.position;
          for (const float away : {at.x - p[0], at.y - p[1], at.z - p[2]})
            far = std::max(far, std::abs(away));
          CHECK(hand.joints[k].radius > 0.0F);
          CHECK(hand.joints[k].radius < 0.05F);
        }
        return true;
      }));
      CHECK(far < 1e-6F);
      run.signal(side == 0 ? 0 : SIGKILL);
      if (side == 1)
        CHECK(
            eventually([&] { return !session.locate(tracker, stage, monotonic_ns()).is_active; }));
    }
    std::filesystem::remove(path); // which a killed run leaves
  }
}

} // namespace openxr_program_test
