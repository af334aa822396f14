#include <nendo/sculpting/open_hand.hpp>

#include <array>
#include <future>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

namespace open_hand_test {

using namespace nendo;

namespace {

/// A glove that sends no sample.
class SilentGlove final : public driver::Glove {
public:
  SilentGlove(driver::SourceKind kind, const driver::StreamCounters& counters) {
    info_.source = "serial:/dev/ttyUSB0";
    info_.rate_hz = 90.0;
    info_.kind = kind;
    static_cast<driver::StreamCounters&>(stats_) = counters;
  }
  const driver::GloveInfo& info() const noexcept override { return info_; }
  Result<void> start(SampleRing& /*ring*/) override { return {}; }
  void stop() noexcept override {}
  driver::StreamStats stats() const noexcept override { return stats_; }
  void set_feedback(const driver::Feedback& /*feedback*/) noexcept override {}

private:
  driver::GloveInfo info_;
  driver::StreamStats stats_;
};

/// Returns the message of the error of a hand whose glove is silent. Blocks for two seconds.
std::string waited_for(driver::SourceKind kind, const driver::StreamCounters& counters) {
  std::array<sculpting::OpenHand, 1> hands;
  hands[0].ring = std::make_unique<SampleRing>(16);
  hands[0].glove = std::make_unique<SilentGlove>(kind, counters);
  const auto came = sculpting::wait_for_samples(hands);
  return came ? "" : came.error().message;
}

} // namespace

TEST_SUITE("open_hand") {
  TEST_CASE("the error of a silent glove says what its bytes show") {
    driver::StreamCounters noise;
    noise.bytes = noise.discarded_bytes = 512;
    driver::StreamCounters unplugged = noise;
    unplugged.unplugged = 9;
    struct Case {
      driver::SourceKind kind;
      driver::StreamCounters counters;
      std::string said;
    };
    const std::vector<Case> cases{
        {driver::SourceKind::device, {}, "switched on"},
        {driver::SourceKind::device, noise, "512 bytes"},
        {driver::SourceKind::device, unplugged, "plug the glove into its interface unit"},
        {driver::SourceKind::recorded, {}, "recording"}};
    std::vector<std::future<std::string>> messages;
    for (const Case& one : cases) // each waits for two seconds
      messages.push_back(std::async(std::launch::async, waited_for, one.kind, one.counters));
    for (std::size_t at = 0; at < cases.size(); ++at) {
      const std::string message = messages[at].get();
      CAPTURE(message);
      CHECK(message.starts_with("serial:/dev/ttyUSB0: opened, but no sample came within 2 s; "));
      CHECK(message.find(cases[at].said) != std::string::npos);
      const bool is_unplugged = cases[at].counters.unplugged > 0;
      CHECK((message.find("interface unit") != std::string::npos) == is_unplugged);
    }
  }
}

} // namespace open_hand_test
