#pragma once
// The look of the live window's widgets.

namespace nendo::viewer {

/// Gives ImGui's widgets the colours and shapes of the browser's page (apps/web/page/page.css).
void use_page_style();

} // namespace nendo::viewer
