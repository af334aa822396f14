// The first byte says how long the reports are that the rest is cut into.

#include "fivedt_usb/fivedt_usb_parser.hpp"

#include "parser_fuzz.hpp"

using namespace nendo::driver::fivedt_usb;

namespace {

void check_report(const Report& report) {
  for (const unsigned value : report.values)
    require(value <= max_count);
}

} // namespace

// NOLINTNEXTLINE(readability-identifier-naming): libFuzzer calls it by this name
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  push_reports<Parser>({data, size}, report_bytes, check_report);
  return 0;
}
