// Any text is a table of counts or an error.

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "sample_table.hpp"

// NOLINTNEXTLINE(readability-identifier-naming): libFuzzer calls it by this name
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace nendo::recording;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto table = parse_sample_table(text, "table", {.rate_hz = 90.0});
  if (!table) {
    const std::string& message = table.error().message;
    if (message.rfind("table", 0) != 0 || message.find('\n') != std::string::npos) std::abort();
    return 0;
  }
  if (table->samples.empty()) std::abort();
  for (std::size_t at = 0; at < table->samples.size(); ++at) {
    const nendo::GloveSample& sample = table->samples[at];
    if (sample.present.bits == 0 || sample.side != table->info.side) std::abort();
    if ((sample.present.bits & ~table->info.sensors.bits) != 0) std::abort();
    if (at > 0 && sample.arrival < table->samples[at - 1].arrival) std::abort();
    for (const nendo::RawCount& count : sample.raw)
      if (count.value > table->info.counts.max_count) std::abort();
  }
  return 0;
}
