#include <cstdlib>

#include <doctest/doctest.h>

#include "session/views.hpp"

namespace open_window_test {

using namespace nendo;

TEST_SUITE("open_window") {
  TEST_CASE("without a screen there is one line that says what to do instead") {
    ::unsetenv("DISPLAY");
    ::unsetenv("WAYLAND_DISPLAY");
    const auto window = session::open_window({});
    REQUIRE_FALSE(window);
    CHECK(window.error().code == Errc::failed);
    CHECK(window.error().message.find("nendo picture") != std::string::npos);
    CHECK(window.error().message.find('\n') == std::string::npos);
  }
}

} // namespace open_window_test
