#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "cli/cli.hpp"
#include "cli/model_files.hpp"
#include "session/views.hpp"
#include "web/model_message.hpp"
#include "web/server.hpp"

namespace nendo::session {
namespace {

/// Returns the text of the devices message.
std::string device_lines(const gloves::DeviceStatuses& devices) {
  std::string lines;
  for (const Side side : {Side::left, Side::right})
    for (const auto& [title, state] : devices[flow::Placement::index_of(side)])
      lines.append(name_of(side)).append("\t").append(title).append("\t").append(state) += '\n';
  return lines;
}

class WebView final : public BrowserView {
public:
  WebView(std::shared_ptr<web::Server> server, std::string model_name) noexcept
      : server_(std::move(server)), model_name_(std::move(model_name)) {}

  Result<void> begin(const LoopStart& start) override {
    placed_ = &start.placed;
    const deform::BlockLayout& layout = placed_->loop->changes().layout();
    if (auto fine = check(layout); !fine) return fine;
    streams_.begin(stream_for(layout));
    server_->set_settings(placed_->loop->changes().settings());
    while (server_->next_command()) { // those that came without a run
    }
    pictures_ = web::pictures_of(start.model);
    server_->present(streams_.now(), message_for(layout, start.model), pictures_);
    update_weights();
    return {};
  }
  void show(const flow::Frame& frame) noexcept override { streams_.of(frame).show(frame); }
  Result<void> prepare(const flow::ModelVersion& version) override {
    if (auto fine = check(version.layout()); !fine) return fine;
    streams_.prepare(stream_for(version.layout()));
    next_model_ = message_for(version.layout(), version.mesh);
    return {};
  }
  Result<void> settle() override {
    if (streams_.settle()) server_->present(streams_.now(), std::move(next_model_), pictures_);
    return {};
  }
  void update(const RunStatus& status, Asks& asks) override {
    server_->set_devices(device_lines(status.devices));
    server_->set_settings(status.frame.settings);
    server_->set_commands(status.situation());
    server_->follow(status.frame, status.puppet.get());
    update_weights();
    pending_.follow(status.frame.settings);
    while (auto asked = server_->next_command()) {
      if (const auto* const row = std::get_if<const commands::Row*>(&*asked)) {
        const commands::Answer answer = commands::press(**row, status.situation(), pending_);
        if (answer.command) asks.emplace_back(*answer.command);
        if (answer.refusal != nullptr) server_->report(answer.refusal, true);
      } else if (const auto* const settings = std::get_if<web::NamedSettings>(&*asked)) {
        settings->apply_to(pending_.now);
        if (const auto change = pending_.ask()) asks.emplace_back(*change);
      } else {
        asks.emplace_back(std::get<flow::Command>(*asked));
      }
    }
  }
  void report(const Report& message) override { server_->report(message.text, message.is_error); }

private:
  Result<void> check(const deform::BlockLayout& layout) const {
    if (layout.vertex_count() <= web::max_vertices) return {};
    return Error{Errc::bad_input, "--web: the model has " + std::to_string(layout.vertex_count()) +
                                      " vertices, and a browser takes at "
                                      "most " +
                                      std::to_string(web::max_vertices) +
                                      "; run it without --web, or reduce the model"};
  }
  std::shared_ptr<web::FrameStream> stream_for(const deform::BlockLayout& layout) const {
    return std::make_shared<web::FrameStream>(layout, frame_capacity(*placed_));
  }
  std::vector<std::byte> message_for(const deform::BlockLayout& layout,
                                     const deform::Mesh& mesh) const {
    const PlacedSetup& setup = placed_->setup;
    return web::model_message(
        layout, mesh, setup.inputs,
        {model_name_, setup.options.rate_hz, setup.placement.units_per_metre});
  }
  // The loop makes another field of a puppet when radii, kernel or model change.
  void update_weights() {
    const auto& surface = placed_->loop->changes().sculptor_options().surface;
    if (!surface || surface->number() == weights_) return;
    weights_ = surface->number();
    server_->add_weights(weights_, web::weights_message(*surface));
  }

  std::shared_ptr<web::Server> server_;
  VersionTarget<web::FrameStream> streams_;
  flow::PendingSettings pending_;     ///< the settings of all clients
  std::uint64_t weights_ = 0;         ///< deform::SurfaceField::number() of the last weights
  web::Pictures pictures_;            ///< the textures of all versions of the model
  std::vector<std::byte> next_model_; ///< the message of the last prepared version
  const PlacedLoop* placed_ = nullptr;
  std::string model_name_; ///< the name on the page
};

} // namespace

Result<std::shared_ptr<web::Server>> open_web_server(const std::string& endpoint) {
  const auto where = parse_endpoint(endpoint, 0);
  if (!where) return Error{Errc::usage, "--web " + endpoint + ": " + where.error().message};
  auto server = web::Server::open(*where);
  if (!server) return server.error();
  cli::note("open in a browser: " + (*server)->url());
  cli::note("or in Foxglove or Lichtblick: " + (*server)->foxglove_url());
  const std::string& address = (*server)->endpoint().address;
  if (address == "0.0.0.0" || address == "::")
    cli::note("on another machine, replace " + address +
              " by this machine's address; the connection is not encrypted, so everyone on the "
              "network can read it");
  return std::shared_ptr<web::Server>(*std::move(server));
}

std::unique_ptr<BrowserView> browser_view(std::shared_ptr<web::Server> server,
                                          const std::string& mesh) {
  return std::make_unique<WebView>(std::move(server), cli::short_name(mesh));
}

} // namespace nendo::session
