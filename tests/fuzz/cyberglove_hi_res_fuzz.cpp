// High-resolution records. The first byte chooses how the rest, the stream, is cut into chunks.

#include "cyberglove/cyberglove_parser.hpp"
#include "cyberglove/record_check.hpp"

#include "parser_fuzz.hpp"

using namespace nendo::driver::cyberglove;

namespace {

constexpr RecordShape shape{hi_res_values, false, false, RecordForm::hi_res};

void check_record(const Record& record) {
  const auto values = std::span(record.values).first(hi_res_values);
  require(std::all_of(values.begin(), values.end(),
                      [](auto value) { return value >= 1 && value <= hi_res_max; }));
  // Frame 30 is the last one of a second, if frames are numbered from 1.
  require(record.second < 24 * 3600 && record.frame <= 30 && record.sub_frame <= 9);
}

} // namespace

// NOLINTNEXTLINE(readability-identifier-naming): libFuzzer calls it by this name
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const auto stream = rest_of({data, size});
  Parser parser(shape);
  std::uint64_t records = 0;
  HiResCheck check((*data & 0x80U) != 0 ? 90.0 : 0.0);
  nendo::HostTime arrival{};
  const auto count = [&](Record& record) {
    arrival += std::chrono::milliseconds(record.values[0]);
    const Verdict verdict = check(record, arrival);
    require(verdict.plausible);
    require(verdict.missed < std::uint64_t{10} * 86'400 * 300); // ten gaps of a day at most
    return verdict;
  };
  push_stream(parser, {stream, 1 + *data % 70U, hi_res_bytes}, [&](auto chunk) {
    parser.push(chunk, count, [&](const Record& record) {
      check_record(record);
      ++records;
    });
    require(parser.counters().records == records);
    require(parser.counters().record_bytes == records * hi_res_bytes);
  });

  // What is found does not depend on what stands before it: every whole record of the stream is
  // found, but where it overlaps one found earlier.
  std::uint64_t whole = 0;
  for (std::size_t at = 0; at + hi_res_bytes <= stream.size(); ++at) {
    const auto record = decode_record(stream.subspan(at, hi_res_bytes), shape);
    if (!record) continue;
    whole += record->no_glove ? 0U : 1U;
    at += hi_res_bytes - 1;
  }
  require(whole == records);
  return 0;
}
