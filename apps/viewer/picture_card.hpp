#pragma once
// Cards: buttons with pictures. Main thread, while a window is open.

#include <string_view>

#include "gl/picture.hpp"

struct ImDrawList;
struct ImVec2;

namespace nendo::viewer {

/// Draws the middle of a picture, that part of its width, into a rectangle.
void draw_picture(ImDrawList& list, const gl::Picture& picture, const ImVec2& low,
                  const ImVec2& high, float part = 1.0F, float rounding = 0.0F);

/// A button `width` pixels wide with a picture, and its name below. Null: an empty frame of
/// `ratio` times its height. Tests press it by its name.
bool picture_card(std::string_view name, const gl::Picture* picture, float ratio, float width,
                  bool is_chosen = false);

} // namespace nendo::viewer
