#pragma once
// The studio on a page in a browser: the start, and runs one after another. No window is needed.

#include <memory>

#include "studio/studio.hpp"
#include "web/server.hpp"

namespace nendo::studio {

/// Shows the studio on the pages of `server`, not null, which also shows its runs.
Result<std::unique_ptr<Studio>> open_page_studio(const StudioOptions& options,
                                                 std::shared_ptr<web::Server> server);

} // namespace nendo::studio
