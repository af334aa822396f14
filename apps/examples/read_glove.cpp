// Reads a glove for a second, and prints the latest count of each sensor, and how fast it sends.
//   read_glove [GLOVE]    GLOVE is as in `nendo run`: sim (the default), auto, serial:/dev/ttyUSB0

#include <chrono>
#include <iostream>
#include <thread>

#include <nendo/driver/open_glove.hpp>

namespace {

using namespace nendo;

int fail(const Error& error) {
  std::cerr << "read_glove: " << error.message << "\n";
  return static_cast<int>(error.code);
}

void print(const GloveSample& sample) {
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    const auto sensor = static_cast<Sensor>(slot);
    if (sample.present.has(sensor))
      std::cout << name_of(sensor) << " " << sample[sensor].value << "\n";
  }
}

} // namespace

int main(int argc, char** argv) {
  auto opened = driver::open_glove(argc > 1 ? argv[1] : "sim");
  if (!opened) return fail(opened.error());
  driver::Glove& glove = **opened;
  SampleRing ring(256); // the glove's thread fills it, and this one empties it
  if (const auto started = glove.start(ring); !started) return fail(started.error());

  GloveSample latest;
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(1);
  while (std::chrono::steady_clock::now() < end) {
    ring.drain([&](const GloveSample& sample) noexcept { latest = sample; });
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  glove.stop(); // before the ring goes

  const driver::StreamStats stats = glove.stats();
  std::cout << glove.info().model << ", " << name_of(glove.info().side) << " hand\n";
  print(latest);
  std::cout << stats.records << " samples, " << stats.bad_records << " bad ones\n";
  return stats.records > 0 ? 0 : 1;
}
