#pragma once
// The browser's view as a run's outlet.

#include <memory>
#include <string>

#include <nendo/web/server.hpp>

#include "session/outlet.hpp"

namespace nendo::session {

class WebOutlet final : public Outlet {
public:
  explicit WebOutlet(std::unique_ptr<web::Server> server) noexcept : server_(std::move(server)) {}

  /// Error: bad_input (a model with more vertices than browsers take).
  Result<void> begin(const PlacedLoop& placed, const deform::Mesh& model,
                     const std::vector<gloves::OpenHand>& hands) override;
  void show(const flow::Frame& frame) noexcept override { tap_->show(frame); }
  /// Also tells the server how the gloves do.
  std::optional<flow::Request> next_request() override;
  std::optional<flow::WristMove> next_wrist() override { return server_->next_wrist(); }
  flow::LoopChange next_change() override { return server_->next_change(); }
  flow::SaveRequest next_save_request() override { return server_->next_save_request(); }
  void tell(const std::string& words) override { server_->tell(words); }

  const web::Server& server() const noexcept { return *server_; }
  std::string name; ///< of the model, for people

private:
  std::unique_ptr<web::Server> server_;
  std::shared_ptr<web::FrameStream> tap_;
  const std::vector<gloves::OpenHand>* hands_ = nullptr;
  HostTime next_look_{};
};

/// Opens the server that --web asks for, and says on standard error where it is to be found. Errors
/// as web::parse_endpoint() and web::Server::open().
Result<std::unique_ptr<WebOutlet>> open_web(const std::string& endpoint, const std::string& mesh);

} // namespace nendo::session
