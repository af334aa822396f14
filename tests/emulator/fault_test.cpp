#include "line/fault.hpp"

#include <chrono>
#include <string>

#include <doctest/doctest.h>

#include <nendo/emulator/emulator.hpp>

namespace fault_test {

using namespace std::chrono_literals;
using namespace nendo::emulator;

TEST_SUITE("fault") {
  TEST_CASE("a rate is a percentage, a time has a unit, and a value follows the times") {
    const auto drop = parse_fault("drop=0.1%");
    REQUIRE(drop);
    CHECK(drop->kind == FaultKind::drop);
    CHECK(drop->rate == doctest::Approx(0.001));
    const auto silence = parse_fault("silence@5s+250ms");
    REQUIRE(silence);
    CHECK(silence->kind == FaultKind::silence);
    CHECK(silence->at == 5s);
    CHECK(silence->lasting == 250ms);
    const auto unplug = parse_fault("unplug@0.5s+2s=/tmp/a=b");
    REQUIRE(unplug);
    CHECK(unplug->at == 500ms);
    CHECK(unplug->value == "/tmp/a=b");
    const auto swap = parse_fault("swap@5s=left");
    REQUIRE(swap);
    CHECK(swap->lasting == 500ms);
    CHECK(parse_fault("swap@5s+2s=18")->lasting == 2s);
    const auto stuck = parse_fault("stick@3s=index_pip:255");
    REQUIRE(stuck);
    const auto incident = incident_of(*stuck, false);
    REQUIRE(incident);
    CHECK(incident->sensor == nendo::Sensor::index_pip);
    CHECK(incident->count == 255);
    const auto slot = parse_fault("stick@0s+2s=5");
    REQUIRE(slot);
    CHECK(slot->lasting == 2s);
    CHECK_FALSE(incident_of(*slot, false)->count);
    CHECK(incident_of(*slot, true)->kind == Incident::Kind::sensor_free);
    const auto error = parse_fault("error@2s=3:k");
    REQUIRE(error);
    CHECK(incident_of(*error, false)->kind == Incident::Kind::tracker_error);
    CHECK(incident_of(*error, false)->station == 3);
    CHECK(incident_of(*error, false)->letter == 'k');
    CHECK(incident_of(*parse_fault("error@2s=X"), false)->station == 0);
  }

  TEST_CASE("what is wrong gets one line that quotes the fault and shows how to write it") {
    for (const std::string text : {"",
                                   "=",
                                   "@",
                                   "drip=1%",
                                   "drop",
                                   "drop=",
                                   "drop=1",
                                   "drop=0%",
                                   "drop=101%",
                                   "drop=nan%",
                                   "drop=inf%",
                                   "drop=-1%",
                                   "drop@5s",
                                   "drop=1%%",
                                   "silence",
                                   "silence@",
                                   "silence@5s",
                                   "silence@5+3s",
                                   "silence@5s+",
                                   "silence@-1s+3s",
                                   "silence@5s+3s=x",
                                   "silence=5s",
                                   "silence@1e9s+1s",
                                   "unplug@5s",
                                   "unplug@5s+2s=",
                                   "eg@5s",
                                   "swap@5s",
                                   "swap@5s=20",
                                   "swap@5s+1s",
                                   "restart@5s+2s",
                                   "stick@5s",
                                   "error@5s",
                                   "error@5s=",
                                   "error@5s=kk",
                                   "error@5s=1",
                                   "error@5s=0:k",
                                   "error@5s=x:k",
                                   "error@5s+2s=k",
                                   "stick@5s=",
                                   "stick@5s=index",
                                   "stick@5s=24",
                                   "stick@5s=5:",
                                   "stick@5s=5:256",
                                   "stick@5s=5:-1",
                                   "stick@5s=5:1.5",
                                   "stick=5:1",
                                   "junk@s",
                                   "junk@5s=1"}) {
      CAPTURE(text);
      const auto fault = parse_fault(text);
      REQUIRE_FALSE(fault);
      CHECK(fault.error().code == nendo::Errc::usage);
      CHECK(fault.error().message.starts_with("fault \"" + text + "\": "));
      CHECK(fault.error().message.find('\n') == std::string::npos);
    }
    CHECK(parse_fault("drip=1%").error().message.find("drop, flip") != std::string::npos);
    CHECK(parse_fault("silence@5s").error().message.find("silence@5s+3s") != std::string::npos);
  }

  TEST_CASE("every form is named as its fault, in the faults' order") {
    const auto forms = fault_forms();
    REQUIRE(forms.size() == fault_kinds);
    for (std::size_t k = 0; k < forms.size(); ++k) {
      const auto name = name_of(static_cast<FaultKind>(k));
      CHECK(forms[k].form.starts_with(name));
      const bool by_chance = forms[k].form[name.size()] == '=';
      std::string example(forms[k].form.substr(0, forms[k].form.find('[')));
      if (by_chance) example = std::string(name) + "=1%";
      if (name == "swap") example = "swap@5s=18";
      if (name == "stick") example = "stick@5s=index_pip:255";
      if (name == "error") example = "error@5s=2:k";
      const auto fault = parse_fault(example);
      REQUIRE(fault);
      CHECK(fault->kind == static_cast<FaultKind>(k));
    }
  }

  TEST_CASE("a kind has one rate but may happen at many times") {
    CHECK(parse_faults({"junk@1s", "junk@2s", "drop=1%"}));
    CHECK_FALSE(parse_faults({"drop=1%", "drop=2%"}));
    CHECK_FALSE(parse_faults({"drop=1%", "nonsense"}));
  }
}

} // namespace fault_test
