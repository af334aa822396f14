// The input is what a client of `nendo serve` sends as one request.

#include "serve/request.hpp"

#include <cstdint>
#include <string_view>

#include "laws.hpp"

using namespace nendo::serve;

// NOLINTNEXTLINE(readability-identifier-naming): libFuzzer calls it by this name
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view request = text_of(data, size);
  const auto watch = changed({}, request);
  if (!watch) {
    require_one_line(watch.error(), "");
    return 0;
  }
  require(watch->rate_hz >= min_rate_hz && watch->rate_hz <= max_rate_hz);
  require(*changed(*watch, request) == *watch); // a second time changes nothing
  return 0;
}
