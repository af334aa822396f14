#pragma once
// The view in a browser. It takes every frame in the tick, and is an observer on the main thread.

#include <memory>
#include <string>

#include "session/observer.hpp"
#include "session/sink.hpp"
#include "web/server.hpp"

namespace nendo::session {

class BrowserView final : public Sink, public Observer {
public:
  /// model_name is the name that the page shows.
  BrowserView(std::unique_ptr<web::Server> server, std::string model_name) noexcept
      : server_(std::move(server)), model_name_(std::move(model_name)) {}

  /// Begins with a loop. Error: bad_input (a model with more vertices than browsers take).
  Result<void> begin(const LoopStart& start) override;
  void show(const flow::Frame& frame) noexcept override { stream_->show(frame); }
  void update(const RunStatus& status, flow::CommandRing& commands) override;
  void report(const std::string& message) override { server_->report(message); }

private:
  std::unique_ptr<web::Server> server_;
  std::shared_ptr<web::FrameStream> stream_;
  std::string model_name_;
};

/// Opens the server that --web asks for, and prints its address on standard error. Errors: those of
/// web::parse_endpoint() and web::Server::open().
Result<std::unique_ptr<BrowserView>> open_browser_view(const std::string& endpoint,
                                                       const std::string& mesh);

} // namespace nendo::session
