#pragma once
// A loop that publishes, and a reader of its segment that goes by nendo_publish.h alone.

#include <random>
#include <string>
#include <vector>

#include <doctest/doctest.h>
#include <nendo_publish.h>
#include <unistd.h>

#include "publish/segment.hpp"
#include "support/flow_fixtures.hpp"
#include "support/mapped_file.hpp"

namespace nendo::test {

inline std::string segment_name(const std::string& what) {
  return "test-" + std::to_string(::getpid()) + "-" + what;
}

inline publish::LoopOutline outline_of(const LoopUnderTest& test) {
  publish::LoopOutline outline;
  outline.model = &test.model;
  outline.layout = &test.loop->changes().layout();
  outline.mode = test.options.sculptor.mode;
  outline.rate_hz = test.options.rate_hz;
  outline.units_per_metre = test.placement.units_per_metre;
  outline.max_fields = test.loop->frames().front().fields.capacity();
  outline.functions =
      static_cast<std::size_t>(test.options.sculptor.deformer.supports.functions(10));
  outline.skeletons = {hand::HandSkeleton(Side::left), hand::HandSkeleton(Side::right)};
  return outline;
}

/// Makes the loop again, with these sinks.
inline void attach(LoopUnderTest& test, std::vector<flow::FrameSink*> sinks) {
  test.options.sinks = std::move(sinks);
  test.loop =
      std::make_unique<flow::DeformLoop>(test.model, test.placement, test.inputs, test.options);
}

class MappedSegment {
public:
  explicit MappedSegment(const std::string& name) : file_("/dev/shm/nendo-" + name) {
    REQUIRE(nendo_publish_is_usable(base(), file_.bytes()));
  }

  const void* base() const { return file_.base(); }
  const nendo_publish_header& header() const {
    return *static_cast<const nendo_publish_header*>(base());
  }
  std::uint64_t newest() const { return nendo_publish_newest(base()); }
  bool has_ended() const { return nendo_publish_state(base()) == NENDO_PUBLISH_ENDED; }
  nendo_publish_setup setup() const {
    nendo_publish_setup setup{};
    REQUIRE(nendo_publish_read_setup(base(), &setup, nullptr, nullptr));
    return setup;
  }
  /// In the model's units, 3 by #vertices.
  deform::Points rest() const {
    nendo_publish_setup setup{};
    std::vector<float> floats(std::size_t{3} * header().vertices);
    REQUIRE(nendo_publish_read_setup(base(), &setup, nullptr, floats.data()));
    return points_of(setup, floats);
  }
  deform::Points shape(std::uint64_t number) const {
    std::vector<float> floats(std::size_t{3} * header().vertices);
    REQUIRE(nendo_publish_read_shape(base(), number, floats.data()));
    return points_of(setup(), floats);
  }
  /// With its fields behind it.
  std::vector<std::uint64_t> record(std::uint64_t number) const {
    std::vector<std::uint64_t> words(header().record_stride / 8);
    auto* const head = reinterpret_cast<nendo_publish_record*>(words.data());
    REQUIRE(
        nendo_publish_read(base(), number, head, head + 1, header().record_stride - sizeof *head));
    return words;
  }

private:
  static deform::Points points_of(const nendo_publish_setup& setup,
                                  const std::vector<float>& floats) {
    deform::Points points(3, static_cast<Eigen::Index>(floats.size() / 3));
    for (Eigen::Index n = 0; n < points.size(); ++n)
      points(n % 3, n / 3) = setup.origin[n % 3] +
                             setup.unit * static_cast<double>(floats[static_cast<std::size_t>(n)]);
    return points;
  }

  MappedFile file_;
};

inline const nendo_publish_record& head_of(const std::vector<std::uint64_t>& words) {
  return *reinterpret_cast<const nendo_publish_record*>(words.data());
}

/// Hands that bend at random, and every request now and then, up to the next tick.
class Player {
public:
  explicit Player(LoopUnderTest& test) : test_(test) {}
  const flow::Frame& next() {
    bent_ = std::clamp(bent_ + static_cast<int>(random_() % 7) - 3, 0, 30);
    test_.bend(bent_, HostClock::now());
    if (tick_ > 10 && random_() % 15 == 0)
      test_.commands.try_push(flow::requests[random_() % flow::requests.size()]);
    // Who releases soon grabs again.
    if (tick_ % 10 == 0) test_.commands.try_push(flow::Request::grab);
    return test_.frame_after_tick(tick_++);
  }

private:
  LoopUnderTest& test_;
  std::mt19937 random_{5};
  int bent_ = 0;
  std::uint64_t tick_ = 0;
};

} // namespace nendo::test
