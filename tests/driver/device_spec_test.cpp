#include <nendo/driver/open_glove.hpp>

#include <memory>
#include <optional>
#include <string>

#include <doctest/doctest.h>

namespace device_spec_test {

using nendo::Errc;
using nendo::driver::glove_drivers;
using nendo::driver::open_glove;
using nendo::driver::parse_device_spec;

TEST_SUITE("glove_spec") {
  TEST_CASE("a specification is kind, target and options") {
    const auto spec = parse_device_spec("sim:pinch?seed=7&rate=100");
    REQUIRE(spec);
    CHECK(spec->text == "sim:pinch?seed=7&rate=100");
    CHECK(spec->kind == "sim");
    CHECK(spec->target == "pinch");
    REQUIRE(spec->options.size() == 2);
    CHECK(spec->options.at("seed") == "7");
    CHECK(spec->options.at("rate") == "100");
  }

  TEST_CASE("target and options may be missing, and a path may contain colons") {
    CHECK(parse_device_spec("auto")->target.empty());
    CHECK(parse_device_spec("sim?seed=1")->options.at("seed") == "1");
    CHECK(parse_device_spec("serial:/dev/serial/by-path/pci-0000:00:14.0-port0")->target ==
          "/dev/serial/by-path/pci-0000:00:14.0-port0");
  }

  TEST_CASE("what cannot be read is a usage error that names it") {
    for (const char* text : {"", ":x", "?a=b", "sim?", "sim?seed", "sim?=7",
                             "sim?seed=", "sim?a=1&", "sim?a=1&a=2", "sim:\n", "sim:\x1b[2J"}) {
      CAPTURE(text);
      const auto spec = parse_device_spec(text);
      REQUIRE_FALSE(spec);
      CHECK(spec.error().code == Errc::usage);
      CHECK(spec.error().message.find('\n') == std::string::npos);
    }
    CHECK(parse_device_spec("sim?a=1&a=2").error().message.find("option a") != std::string::npos);
  }

  TEST_CASE("a bare path is answered by how to write it") {
    const auto glove = open_glove("/dev/ttyUSB0");
    REQUIRE_FALSE(glove);
    CHECK(glove.error().code == Errc::usage);
    CHECK(glove.error().message.find("serial:/dev/ttyUSB0") != std::string::npos);
  }

  TEST_CASE("an unknown kind is answered by the known ones") {
    const auto glove = open_glove("mouse:/dev/input/mouse0");
    REQUIRE_FALSE(glove);
    CHECK(glove.error().code == Errc::usage);
    for (const char* known : {"mouse", "serial", "auto", "sim"}) {
      CHECK(glove.error().message.find(known) != std::string::npos);
    }
  }

  TEST_CASE("unknown options and values are usage errors that name the known ones") {
    const auto option = open_glove("serial:/dev/ttyUSB0?speed=9600");
    REQUIRE_FALSE(option);
    CHECK(option.error().code == Errc::usage);
    CHECK(option.error().message.find("speed") != std::string::npos);
    CHECK(option.error().message.find("baud") != std::string::npos);
    const auto value = open_glove("serial:/dev/ttyUSB0?baud=1");
    REQUIRE_FALSE(value);
    CHECK(value.error().code == Errc::usage);
    CHECK(value.error().message.find("115200") != std::string::npos);
    CHECK(open_glove("serial:").error().code == Errc::usage);
    CHECK(open_glove("auto:both").error().code == Errc::usage);
    CHECK(open_glove("auto?baud=9600").error().code == Errc::usage);
  }

  TEST_CASE("every driver has a line of help that begins with its kind") {
    const auto drivers = glove_drivers();
    CHECK(drivers.size() >= 3);
    for (const auto& driver : drivers) {
      CHECK(driver.grammar.starts_with(driver.kind));
      CHECK_FALSE(driver.summary.empty());
    }
  }

  TEST_CASE("a program adds kinds of gloves, which are opened and listed like the library's") {
    nendo::driver::GloveContext context;
    context.drivers.push_back({"broken", "broken:PATH", "a glove that is broken",
                               [](const auto& spec, auto, const auto&)
                                   -> nendo::Result<std::unique_ptr<nendo::driver::Glove>> {
                                 return nendo::Error{Errc::no_device, "no " + spec.target};
                               }});
    const auto broken = open_glove("broken:here", std::nullopt, context);
    REQUIRE_FALSE(broken);
    CHECK(broken.error().code == Errc::no_device);
    CHECK(broken.error().message == "broken:here: no here");
    CHECK(glove_drivers(context).back().grammar == "broken:PATH");
    CHECK(open_glove("mouse", std::nullopt, context).error().message.ends_with("broken"));
    for (const std::string unknown : {"broken", "replay"})
      CHECK(open_glove(unknown + ":here").error().message.find("unknown kind " + unknown) !=
            std::string::npos);
  }
}

} // namespace device_spec_test
