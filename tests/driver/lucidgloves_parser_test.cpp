#include "lucidgloves/lucidgloves_parser.hpp"

#include <array>
#include <cctype>
#include <random>
#include <span>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include <doctest/doctest.h>

#include "support/captures.hpp"

namespace lucidgloves_parser_test {

using namespace nendo;
using namespace nendo::driver::lucidgloves;

namespace {

// As a firmware with splay sensors sends it, with the letters of two pressed buttons.
const std::string full = "A100B200C300D400E500F2048G2047P0HL(AB)600(BB)700(CB)800(DB)900(EB)1000\n";
const std::string plain = "A1B2C3D4E5F2048G2048P0\n";

struct Outcome {
  std::vector<Line> lines;
  nendo::driver::StreamCounters counters;
  std::size_t pending = 0;
};

/// Of a stream that begins with a line's beginning.
Outcome parse(std::string_view text, std::uint16_t range = esp32_range) {
  Parser parser(range);
  Outcome outcome;
  const std::string input = "\n" + std::string(text);
  parser.push(std::as_bytes(std::span(input)),
              [&](const Line& line) { outcome.lines.push_back(line); });
  test::check_accounted(parser, input.size(), max_line_bytes);
  outcome.counters = parser.counters();
  outcome.pending = parser.pending();
  return outcome;
}

GloveSample sample_of(std::string_view text, std::uint16_t range = esp32_range) {
  const auto line = decode_line(text, range);
  REQUIRE(line);
  GloveSample sample;
  fill_slots(*line, range, sample);
  return sample;
}

/// The slots that are present, as text: what a capture's expectation holds.
std::string written(const GloveSample& sample) {
  std::ostringstream text;
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    if (!sample.present.has(static_cast<Sensor>(slot))) continue;
    text << (text.tellp() > 0 ? " " : "") << sensor_names[slot] << '=' << sample.raw[slot].value;
  }
  return text.str();
}

} // namespace

TEST_SUITE("lucidgloves_parser") {
  TEST_CASE("empty input and empty lines yield nothing and are no fault") {
    CHECK(parse("").lines.empty());
    const Outcome outcome = parse("\n\r\n\n");
    CHECK(outcome.lines.empty());
    CHECK(outcome.counters.bad_records == 0);
  }

  TEST_CASE("a good line is delivered as it was sent, whatever its end") {
    for (const std::string& text : {full, full.substr(0, full.size() - 1) + "\r\n"}) {
      const Outcome outcome = parse(text);
      REQUIRE(outcome.lines.size() == 1);
      const Line& line = outcome.lines[0];
      for (std::uint16_t k = 0; k < fingers; ++k) {
        CHECK(line.curl[k] == 100 * (k + 1));
        CHECK(line.splay[k] == 600 + 100 * k);
        for (const auto& joint : line.joint[k])
          CHECK_FALSE(joint);
      }
      CHECK_FALSE(line.legacy);
      CHECK_FALSE(line.informs());
      CHECK(outcome.counters.records == 1);
      CHECK(outcome.counters.record_bytes == text.size());
    }
  }

  TEST_CASE("two lines in a row are two lines") {
    const Outcome outcome = parse(plain + full);
    REQUIRE(outcome.lines.size() == 2);
    CHECK(outcome.lines[0].curl[4] == 5);
    CHECK(outcome.lines[1].curl[4] == 500);
  }

  TEST_CASE("a line whose beginning was not seen is skipped, though it looks like one") {
    Parser parser(esp32_range);
    int lines = 0;
    const std::string input = "D400E500\n" + plain;
    parser.push(std::as_bytes(std::span(input)), [&](const Line& line) {
      ++lines;
      CHECK(line.curl[0] == 1);
    });
    CHECK(lines == 1);
    CHECK(parser.counters().bad_records == 0);
    test::check_accounted(parser, input.size(), max_line_bytes);
  }

  TEST_CASE("garbage before a line costs that line and no other") {
    const Outcome outcome = parse("\x01\x02 AT+" + plain + plain);
    CHECK(outcome.lines.size() == 1);
    CHECK(outcome.counters.bad_records == 1);
  }

  TEST_CASE("a truncated line is held back, and is damage when the next follows at once") {
    const Outcome held = parse("A1B2C");
    CHECK(held.lines.empty());
    CHECK(held.pending == 5);
    // C and A ran into each other, or the values of two lines.
    for (const char* cut : {"A1B2C", "A1B2C3"}) {
      const Outcome outcome = parse(cut + plain + full);
      REQUIRE(outcome.lines.size() == 1);
      CHECK(outcome.lines[0].curl[0] == 100);
      CHECK(outcome.counters.bad_records == 1);
    }
  }

  TEST_CASE("an over-long line is dropped as one, whatever its length, and holds no memory") {
    for (const std::size_t length : {std::size_t{255}, std::size_t{256}, std::size_t{5000}}) {
      CAPTURE(length);
      const Outcome outcome = parse(std::string(length, 'Q') + "\n" + plain);
      CHECK(outcome.lines.size() == 1);
      CHECK(outcome.counters.bad_records == 1);
      CHECK(outcome.counters.discarded_bytes == 1 + length + 1);
    }
    const std::string longest = "A1" + std::string(253, 'Q') + "\n"; // 256 with its end
    CHECK(parse(longest).counters.bad_records == 1);                 // Q occurs twice
    std::string numbered = "A1";
    while (numbered.size() < 250)
      numbered += "(QQ)12";
    CHECK(parse(numbered + "\n").lines.size() == 1);
  }

  TEST_CASE("a carriage return alone ends no line") {
    CHECK(parse("A1B2C3D4E5\rA1B2C3D4E5\r\n").lines.empty());
  }

  TEST_CASE("values above the range become the range") {
    for (const std::uint16_t range : {avr_range, esp32_range}) {
      for (const unsigned number : {0U, 1U, range - 1U, unsigned{range}}) {
        const auto line = decode_line("A" + std::to_string(number) + "(AB)7", range);
        REQUIRE(line);
        CHECK(line->curl[0] == number);
        CHECK(line->above_range == 0);
        CHECK(line->below_range == 0);
      }
      for (const unsigned number : {range + 1U, 2U * range, 65'535U}) {
        const std::string text = std::to_string(number);
        const auto line = decode_line("A" + text + "B5(CB)" + text + "(DAB)" + text, range);
        REQUIRE(line);
        CHECK(line->curl[0] == range);
        CHECK(line->curl[1] == 5);
        CHECK(line->splay[2] == range);
        CHECK(line->joint[3][1] == range);
        CHECK(line->above_range == 3);
        CHECK(line->below_range == 0);
      }
    }
    const auto legacy = decode_line("1&5000&3&4&5&6&7&8&9&10&11&12&13", 4095);
    REQUIRE(legacy);
    CHECK(legacy->curl[1] == 4095);
    CHECK(legacy->above_range == 1);
  }

  TEST_CASE("negative values become 0, and the rest of the line is read") {
    const auto alpha = decode_line("A-37B2C-1D4E5F-9G2P3(AB)-4095(BB)9(CAB)-1", 4095);
    REQUIRE(alpha);
    CHECK(alpha->below_range == 4);
    CHECK(alpha->above_range == 0);
    CHECK(alpha->curl == std::array<Line::Value, 5>{0, 2, 0, 4, 5});
    CHECK(alpha->splay[0] == 0);
    CHECK(alpha->splay[1] == 9);
    CHECK(alpha->joint[2][1] == 0);
    const auto legacy = decode_line("-1&2&-300&4&5000&2048&-2048&0&0&0&0&0&0", 4095);
    REQUIRE(legacy);
    CHECK(legacy->legacy);
    CHECK(legacy->below_range == 2);
    CHECK(legacy->above_range == 1);
    CHECK(legacy->curl == std::array<Line::Value, 5>{0, 2, 0, 4, 4095});
    const auto zero = decode_line("A-0", 4095);
    REQUIRE(zero);
    CHECK(zero->below_range == 0);
    for (const char* text : {"A-", "A--1", "A-B2", "-A1", "A1-", "1&-&3&4&5&6&7&8&9&10&11&12&13",
                             "A1(ZV)-5", "A1(ZH)-1"}) {
      CAPTURE(text);
      CHECK_FALSE(decode_line(text, 4095));
    }
  }

  TEST_CASE("values very far out of range are read where no other value is missing beside them") {
    for (const char* number : {"65536", "409500", "-65536", "-409500", "2147483647"}) {
      CAPTURE(number);
      const std::string far(number);
      const bool negative = far.starts_with('-');
      const auto curls = decode_line("A1B2C" + far + "D4E5", 4095);
      REQUIRE(curls);
      CHECK(curls->curl[2] == (negative ? 0 : 4095));
      CHECK(curls->above_range + curls->below_range == 1);
      CHECK(decode_line("A1B2C3D4E5(AB)1(BB)" + far + "(CB)3(DB)4(EB)5", 4095));
      CHECK(decode_line("1&2&3&4&" + far + "&6&7&8&9&10&11&12&13", 4095));
      CHECK_FALSE(decode_line("A1C" + far + "D4E5", 4095)); // B's letter may have been lost
      CHECK_FALSE(decode_line("A1B2C3D4E5(AB)" + far + "(CB)3(DB)4(EB)5", 4095));
      CHECK_FALSE(decode_line("A1B2C3D4E5(CAB)" + far, 4095));
    }
  }

  TEST_CASE("the first piece counts if it is a whole line, for those who want it") {
    const auto first_of = [](std::string_view text) {
      Parser parser(4095, FirstPiece::take_if_whole);
      int lines = 0;
      parser.push(std::as_bytes(std::span(text)), [&](const Line&) { ++lines; });
      CHECK(parser.counters().bad_records == 0);
      CHECK(parser.counters().bytes ==
            parser.counters().record_bytes + parser.counters().discarded_bytes + parser.pending());
      return lines;
    };
    CHECK(first_of("A1B2C3D4E5\n") == 1);
    CHECK(first_of("1&2&3&4&5&6&7&8&9&10&11&12&13\r\n") == 1);
    CHECK(first_of("B2C3D4E5F6\n") == 0);
    CHECK(first_of("2B3C4D5E6\n") == 0);
    CHECK(first_of("&2&3&4&5&6&7&8&9&10&11&12&13\n") == 0);
    CHECK(first_of("rst:0x1 (POWERON_RESET)\nA1B2C3D4E5\n") == 1);
    CHECK(first_of(std::string(300, '1') + "\nA1\n") == 1);
    CHECK(first_of("(ZV)5\n") == 0);
  }

  TEST_CASE("numbers that no firmware sends are refused") {
    CHECK(decode_line("A00004095", 4095));
    for (const char* text :
         {"A65536", "A65537", "A40954095", "A4294967296", "A4294967297", "A99999999999999999999",
          "(AB)65536", "(BAB)65536", "A-65536", "A1.5", "A", "(AB)", "(BAB)", "A1B"}) {
      CAPTURE(text);
      CHECK_FALSE(decode_line(text, 4095));
    }
    CHECK(decode_line("A1P4294967295", 4095));       // nothing that is measured
    CHECK_FALSE(decode_line("A1P4294967296", 4095)); // no number of any firmware
  }

  TEST_CASE("a key that comes twice is two lines that ran into one") {
    for (const char* text : {"A1A1", "A1B2A1", "(AB)1(AB)1", "(BAC)1(BAC)2", "A1F1F1", "A1HH",
                             "A1(ZV)1(ZV)1", "A1LMNL"}) {
      CAPTURE(text);
      CHECK_FALSE(decode_line(text, 4095));
    }
    CHECK(decode_line("A1B2C3D4E5F1G2HIJKLMNOP3", 4095));
  }

  TEST_CASE("keys of other firmwares are passed over, junk is not") {
    for (const char* text : {"A1Q", "A1Q7", "A1(QQ)5", "A1(AC)5", "A1(AAE)5", "A1(ABCDEF)5",
                             "A1(A)5", "A1(FB)9", "A1(ZX)3"}) {
      CAPTURE(text);
      const auto line = decode_line(text, 4095);
      REQUIRE(line);
      CHECK(line->curl[0] == 1);
      CHECK_FALSE(line->splay[0]);
    }
    for (const char* text : {"a1", "A1 B2", "A1(", "A1()", "A1(AB", "A1(Ab)1", "A1)", "A1((AB)1",
                             "A1(A1)2", "A1\xC3", " A1", "A1,B2", "A1\r"}) {
      CAPTURE(text);
      CHECK_FALSE(decode_line(text, 4095));
    }
    CHECK_FALSE(decode_line(std::string_view("A1\0B2", 5), 4095));
  }

  TEST_CASE("a line without values of the hand is no record") {
    CHECK_FALSE(decode_line("F2048G2048P0H", 4095));
    CHECK_FALSE(decode_line("(QQ)1", 4095));
    const Outcome outcome = parse("(ZV)5(ZG)0(ZH)1\n");
    REQUIRE(outcome.lines.size() == 1);
    CHECK(outcome.lines[0].informs());
    CHECK_FALSE(outcome.lines[0].measures());
    CHECK(outcome.lines[0].firmware == 5);
    CHECK(outcome.lines[0].device == 0);
    CHECK(outcome.lines[0].hand == 1);
    CHECK(outcome.counters.records == 0);
    CHECK(outcome.counters.bad_records == 0);
  }

  TEST_CASE("the legacy encoding is thirteen numbers, no more and no less") {
    const auto line = decode_line("10&20&30&40&50&2048&2048&0&1&0&0&1&0", 4095);
    REQUIRE(line);
    CHECK(line->legacy);
    for (std::uint16_t k = 0; k < fingers; ++k)
      CHECK(line->curl[k] == 10 * (k + 1));
    for (const char* text :
         {"1&2&3&4&5", "1&2&3&4&5&6&7&8&9&10&11&12", "1&2&3&4&5&6&7&8&9&10&11&12&13&14",
          "1&2&3&4&5&6&7&8&9&10&11&12&", "1&2&3&4&5&6&7&8&9&10&11&12&13&",
          "1&&3&4&5&6&7&8&9&0&1&2&3", "1&2&3&4&4294967296&6&7&8&9&10&11&12&13",
          "1&2&3&4&5&6&7&8&9&10&11&12&13A1"}) {
      CAPTURE(text);
      CHECK_FALSE(decode_line(text, 4095));
    }
  }

  TEST_CASE("a whole finger's curl counts as its knuckle unless the line has a value for that") {
    CHECK(written(sample_of("A1B2C3D4E5")) ==
          "thumb_mcp=1 index_mcp=2 middle_mcp=3 ring_mcp=4 little_mcp=5");
    for (const char* text : {"B9(BAA)1(BAB)2(BAC)3(BAD)4", "(BAD)4(BAC)3(BAB)2(BAA)1B9"}) {
      CHECK(written(sample_of(text)) == "index_mcp=2 index_pip=3 index_dip=4");
    }
    CHECK(written(sample_of("B9(BAC)3")) == "index_mcp=9 index_pip=3");
    CHECK(written(sample_of("(AAA)1(AAB)2(AAC)3(AAD)4")) == "thumb_mcp=2 thumb_ip=3");
    CHECK(written(sample_of("(EAB)5(EAC)6(EAD)7")) == "little_mcp=5 little_pip=6 little_dip=7");
  }

  TEST_CASE("splays become the angles between neighbours, closed alike and spread alike") {
    const char* const names = "index_middle_abduction=";
    CHECK(written(sample_of("(BB)2048(CB)2048")) == std::string(names) + "0");
    CHECK(written(sample_of("(BB)2148(CB)2048")) == std::string(names) + "200");
    CHECK(written(sample_of("(BB)1948(CB)2048")) == std::string(names) + "200");
    CHECK(written(sample_of("(BB)0(CB)4095")) == std::string(names) + "4095");
    CHECK(written(sample_of("(BB)0(CB)1023", 1023)) == std::string(names) + "1023");
    CHECK(written(sample_of("(AB)77(BB)1(DB)2")) == "thumb_abduction=77"); // no two neighbours
    CHECK(written(sample_of("(CB)10(DB)20(EB)40")) ==
          "middle_ring_abduction=20 ring_little_abduction=40");
  }

  TEST_CASE("where a LucidGlove's stream is cut makes no difference") {
    const auto stream = test::bytes_of("\nnoise\n" + full + std::string(300, 'Q') + "\r\n" + plain +
                                       "A1A1\n" + full + "(ZH)0\n" + plain);
    const auto value_of = [](const Line& line) { return line.curl[0].value_or(0); };
    CHECK(test::values_however_cut<Line>(Parser(esp32_range), {stream, max_line_bytes}, value_of) ==
          std::vector<int>{100, 1, 100, 0, 1});
  }

  TEST_CASE("every byte of a LucidGlove's stream is accounted for, however it is mutilated") {
    std::mt19937 random(5);
    std::uint64_t records = 0;
    for (int round = 0; round < 300; ++round) {
      std::string stream;
      for (int k = 0; k < 20; ++k)
        stream += k % 3 == 0 ? plain : full;
      for (auto k = random() % 30; k > 0; --k) {
        const std::size_t at = random() % stream.size();
        switch (random() % 3) {
        case 0:
          stream[at] = static_cast<char>(random());
          break;
        case 1:
          stream.erase(at, 1 + random() % 9);
          break;
        default:
          stream.insert(at, 1, static_cast<char>(random()));
        }
      }
      for (const Line& line : parse(stream).lines) {
        CHECK((line.measures() || line.informs()));
        for (const auto& value : line.curl)
          CHECK(value.value_or(0) <= 4095);
      }
      records += parse(stream).counters.records;
    }
    CHECK(records > 300 * 5); // the damage is local
  }

  TEST_CASE("after a reset the unfinished line is discarded and the rest of it skipped") {
    Parser parser(esp32_range);
    int lines = 0;
    const auto push = [&](const std::string& text) {
      parser.push(std::as_bytes(std::span(text)), [&](const Line&) { ++lines; });
    };
    push("\nA1B2");
    parser.reset();
    parser.count_discarded(7);
    push("C3D4\n" + plain);
    CHECK(lines == 1);
    CHECK(parser.counters().bad_records == 0);
    test::check_accounted(parser, 5 + 7 + 5 + plain.size(), max_line_bytes);
  }

  TEST_CASE("a file of lines yields what was worked out for it by hand") {
    for (const char* name : {"lucidgloves_alpha.txt", "lucidgloves_legacy.txt"}) {
      const auto line_of = [](const Line& line) {
        GloveSample sample;
        fill_slots(line, esp32_range, sample);
        return written(sample);
      };
      test::reads_as_expected<Line>(Parser(esp32_range), {name, max_line_bytes}, line_of);
    }
  }
}

} // namespace lucidgloves_parser_test
