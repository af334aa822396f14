// The first byte says how long the reports are that the rest is cut into.

#include "p5/p5_parser.hpp"

#include "parser_fuzz.hpp"

using namespace nendo::driver::p5;

namespace {

void check_report(const Report& report) {
  for (const unsigned bend : report.bends)
    require(bend <= max_bend);
}

} // namespace

// NOLINTNEXTLINE(readability-identifier-naming): libFuzzer calls it by this name
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  push_reports<Parser>({data, size}, report_bytes, check_report);
  return 0;
}
