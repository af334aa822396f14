// Any text is a table of counts or an error.

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "laws.hpp"
#include "sample_table.hpp"

// NOLINTNEXTLINE(readability-identifier-naming): libFuzzer calls it by this name
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace nendo::recording;
  const auto table = parse_sample_table(text_of(data, size), "table", {.rate_hz = 90.0});
  if (!table) {
    require_one_line(table.error(), "table");
    return 0;
  }
  require(!table->samples.empty());
  for (std::size_t at = 0; at < table->samples.size(); ++at) {
    const nendo::GloveSample& sample = table->samples[at];
    require(sample.present.bits != 0 && sample.side == table->info.side);
    require((sample.present.bits & ~table->info.sensors.bits) == 0);
    require(at == 0 || sample.arrival >= table->samples[at - 1].arrival);
    for (const nendo::RawCount& count : sample.raw)
      require(count.value <= table->info.counts.max_count);
  }
  return 0;
}
