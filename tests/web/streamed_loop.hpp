#pragma once
// A loop over two hands that a test bends, and the stream of its frames.

#include <memory>

#include "support/flow_fixtures.hpp"
#include "web/frame_stream.hpp"
#include "web/model_message.hpp"

namespace nendo::test {

struct StreamedLoopOptions {
  std::optional<deform::InjectiveOptions> injective = std::nullopt;
  deform::Supports supports = deform::one_radius(0.5);
  std::optional<double> swapped_length_m =
      std::nullopt;             ///< length of the hands that may be swapped in
  const char* puppet = nullptr; ///< the text of its file; its supports are used then
};

struct StreamedLoop {
  LoopUnderTest test;
  std::shared_ptr<web::FrameStream> stream;
  std::vector<std::byte> model;

  explicit StreamedLoop(flow::Mode mode, const StreamedLoopOptions& options = {})
      : test(mode,
             {.rings_of_ball = 12, .injective = options.injective, .puppet = options.puppet}) {
    const deform::Supports supports =
        test.options.rig ? test.options.rig->supports() : options.supports;
    const Eigen::Index points = test.options.rig ? test.options.rig->starts().cols() : 10;
    test.options.sculptor.deformer.supports = supports;
    if (options.swapped_length_m)
      for (auto& hand : test.inputs)
        hand.wearer.of(opposite(hand.side)).size = {*options.swapped_length_m, 0.07};
    const deform::BlockLayout layout(test.model.vertices);
    constexpr std::size_t max_fields = 64;
    stream = std::make_shared<web::FrameStream>(
        layout, flow::FrameCapacity{max_fields,
                                    static_cast<std::size_t>(
                                        std::max<Eigen::Index>(20, 2 * supports.functions(points))),
                                    static_cast<std::size_t>(2 * points)});
    test.options.sinks = {stream.get()};
    make_loop();
    model = web::model_message(test.loop->changes().layout(), test.model, test.inputs,
                               {"ball", 1000.0, test.placement.units_per_metre});
  }

  /// Bends both hands by so many counts and ticks. Returns the shape in the mesh's order.
  deform::Points tick(int bent) {
    test.bend(bent, HostClock::now());
    return test.vertices_of(test.frame_after_tick(next_++));
  }

private:
  void make_loop() {
    test.loop =
        std::make_unique<flow::DeformLoop>(test.model, test.placement, test.inputs, test.options);
  }
  std::uint64_t next_ = 0;
};

} // namespace nendo::test
