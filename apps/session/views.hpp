#pragma once
// The views of a run: a window on this machine, and a page in browsers.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "forms/run_panel.hpp"
#include "session/observer.hpp"
#include "session/sink.hpp"

namespace nendo::viewer {
class LiveWindow;
class SceneWindow;
} // namespace nendo::viewer
namespace nendo::web {
class Server;
} // namespace nendo::web

namespace nendo::session {

struct ViewOptions {
  bool window = false;
  bool contact = false;       ///< initially shows where hands touch clay
  std::string theme{"light"}; ///< or dark
  std::string screenshot;     ///< the file for the last picture, .png; empty: none
  std::uint32_t frames = 0;   ///< pictures after which the run ends; 0: no limit
};

/// Returns what panels show of the devices.
forms::DeviceLines device_lines(const gloves::DeviceStatuses& devices);

/// A run in a window.
class WindowView : public Observer {
public:
  virtual viewer::LiveWindow& window() noexcept = 0;
  /// Shows the run's model again, after something else was shown in the window.
  virtual void show_again(const RunStatus& status) = 0;
};

/// Opens a window. Main thread, also for all calls of the window. Errors: failed (no screen, no
/// OpenGL, or built without windows); the message has a remedy.
Result<std::shared_ptr<viewer::SceneWindow>> open_window(const ViewOptions& options);
/// Shows the run in `window`, not null.
std::unique_ptr<WindowView> live_view(const ViewOptions& options, const RunOptions& run,
                                      std::shared_ptr<viewer::SceneWindow> window);

/// Receives every frame in the tick, and observes the run on the main thread.
class BrowserView : public Sink, public Observer {};

/// Error: bad_input, in the words of --web, if a model has more than `most` vertices.
Result<void> check_for_browsers(std::size_t vertices, std::size_t most);
/// Opens the server for --web, and prints its address on standard error. Errors: those of
/// parse_endpoint() and web::Server::open().
Result<std::shared_ptr<web::Server>> open_web_server(const std::string& endpoint);
/// Shows a run on the server's page. The view's begin() and prepare() return bad_input for a model
/// with more vertices than browsers take.
std::unique_ptr<BrowserView> browser_view(std::shared_ptr<web::Server> server,
                                          const std::string& mesh);

} // namespace nendo::session
