#pragma once
// A window for tests.

#include <memory>

#include <doctest/doctest.h>

#include "viewer/scene_window.hpp"

namespace nendo::test {

/// Opens a window, without which the test fails.
inline std::shared_ptr<viewer::SceneWindow> open_window(const viewer::WindowLook& look) {
  auto opened = viewer::SceneWindow::open("test", look, "nothing else");
  REQUIRE_MESSAGE(opened, (opened ? "" : opened.error().message));
  return *std::move(opened);
}

} // namespace nendo::test
