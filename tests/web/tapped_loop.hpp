#pragma once
// A loop over two hands of the test's with a tap at it.

#include <memory>

#include <nendo/web/frame_stream.hpp>
#include <nendo/web/model_message.hpp>

#include "support/flow_fixtures.hpp"

namespace nendo::test {

struct TappedLoop {
  LoopUnderTest test;
  std::shared_ptr<web::FrameStream> tap;
  std::vector<std::byte> model;

  explicit TappedLoop(flow::Mode mode,
                      std::optional<deform::InjectiveOptions> injective = std::nullopt,
                      const deform::Supports& supports = deform::one_radius(0.5),
                      std::optional<double> swapped_length_m = std::nullopt)
      : test(mode, 12, 1000.0, flow::SwitchAction::none, true, hand::FilterKind::off, std::nullopt,
             nullptr, injective) {
    test.options.sculptor.deformer.supports = supports;
    if (swapped_length_m)
      for (auto& hand : test.inputs)
        hand.swapped_skeleton.emplace(hand.skeleton.side(),
                                      hand::HandSize{*swapped_length_m, 0.07});
    const deform::BlockLayout layout(test.model.vertices);
    make_loop(); // to ask it how many fields a frame may have
    tap =
        std::make_shared<web::FrameStream>(layout, mode, test.loop->frames().front().fields.room(),
                                           static_cast<std::size_t>(supports.functions(10)));
    test.options.sinks = {tap.get()};
    make_loop();
    model = web::model_message(
        test.loop->layout(), test.model, test.inputs,
        {"ball", 1000.0, test.placement.units_per_metre, {mode, deform::Wendland::c2, {}}, false});
  }

  /// Both hands bend by so many counts, and the loop ticks.
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
