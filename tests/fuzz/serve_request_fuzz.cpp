// The input is what a client of `nendo serve` sends as one request.

#include "serve/request.hpp"

#include <cstdint>
#include <cstdlib>
#include <string_view>

using namespace nendo::serve;

namespace {

void require(bool law) {
  if (!law) std::abort();
}

} // namespace

// NOLINTNEXTLINE(readability-identifier-naming): libFuzzer calls it by this name
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view request(reinterpret_cast<const char*>(data), size);
  const auto watch = changed({}, request);
  if (!watch) {
    require(watch.error().message.find('\n') == std::string::npos);
    return 0;
  }
  require(watch->rate_hz >= min_rate_hz && watch->rate_hz <= max_rate_hz);
  require(*changed(*watch, request) == *watch); // a second time changes nothing
  return 0;
}
