// The loop embedded in another program: a simulated glove shapes a small mesh for a tenth of a
// second.

#include <iostream>

#include <nendo/driver/open_glove.hpp>
#include <nendo/flow/deform_loop.hpp>

int main() {
  nendo::SampleRing ring(256);
  auto glove = nendo::driver::open_glove("sim:grasp", nendo::Side::right);
  if (!glove || !(*glove)->start(ring)) return 1;
  nendo::GloveSample first;
  while (!ring.try_pop(first)) {
  }

  nendo::deform::Mesh model;
  model.vertices = nendo::deform::Points::Random(3, 100);
  nendo::flow::LoopOptions options;
  options.sculptor.deformer.supports = nendo::deform::one_radius(0.5);
  nendo::flow::HandInput hand{&ring, nendo::Side::right, {}, first}; // an average wearer
  nendo::flow::DeformLoop loop(model, {}, {hand}, options);
  std::atomic<bool> stop{false};
  loop.run(stop, 9);
  (*glove)->stop();

  std::cout << loop.stats().ticks << " ticks, " << loop.final_shape().cols() << " vertices\n";
  return loop.stats().ticks > 0 && loop.final_shape().allFinite() ? 0 : 1;
}
