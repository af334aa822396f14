#pragma once
// The view in a browser. It takes every frame in the tick, and is an observer on the main thread.

#include <memory>
#include <string>

#include "session/observer.hpp"
#include "session/sink.hpp"
#include "session/version_target.hpp"
#include "web/server.hpp"

namespace nendo::session {

class BrowserView final : public Sink, public Observer {
public:
  /// model_name is the name that the page shows.
  BrowserView(std::unique_ptr<web::Server> server, std::string model_name) noexcept
      : server_(std::move(server)), model_name_(std::move(model_name)) {}

  /// Begins with a loop. Error: bad_input (a model with more vertices than browsers take).
  Result<void> begin(const LoopStart& start) override;
  void show(const flow::Frame& frame) noexcept override { streams_.of(frame).show(frame); }
  /// Error: as begin().
  Result<void> prepare(const flow::ModelVersion& version) override;
  /// Browsers then get the new model.
  Result<void> settle() override;
  void update(const RunStatus& status, Asks& asks) override;
  void report(const std::string& message) override { server_->report(message); }

private:
  Result<void> check(const deform::BlockLayout& layout) const;
  std::shared_ptr<web::FrameStream> stream_for(const deform::BlockLayout& layout) const;
  std::vector<std::byte> message_for(const deform::BlockLayout& layout,
                                     const deform::Mesh& mesh) const;

  std::unique_ptr<web::Server> server_;
  VersionTarget<web::FrameStream> streams_;
  void follow_weights();

  flow::WantedSettings wanted_;       ///< that all clients choose
  std::uint64_t weights_ = 0;         ///< deform::SurfaceField::number() of those given last
  web::Pictures pictures_;            ///< of all versions of the model
  std::vector<std::byte> next_model_; ///< message of the version that was prepared last
  const PlacedLoop* placed_ = nullptr;
  std::string model_name_;
};

/// Opens the server that --web asks for, and prints its address on standard error. Errors: those of
/// web::parse_endpoint() and web::Server::open().
Result<std::unique_ptr<BrowserView>> open_browser_view(const std::string& endpoint,
                                                       const std::string& mesh);

} // namespace nendo::session
