#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cli/cli.hpp"
#include "cli/model_files.hpp"
#include "session/views.hpp"
#include "web/model_message.hpp"
#include "web/page_panel.hpp"
#include "web/server.hpp"

namespace nendo::session {
namespace {

using Clock = std::chrono::steady_clock;
/// Between messages of the panel, and of the status bar, whose figures are to be read.
constexpr std::chrono::milliseconds panel_period(33), status_period(200);

class WebView final : public BrowserView {
public:
  WebView(std::shared_ptr<web::Server> server, std::string model_name) noexcept
      : server_(std::move(server)), model_name_(std::move(model_name)) {}

  Result<void> begin(const LoopStart& start) override {
    placed_ = &start.placed;
    const deform::BlockLayout& layout = placed_->loop->changes().layout();
    if (auto fine = check_for_browsers(layout.vertex_count(), web::max_vertices); !fine)
      return fine;
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
    if (auto fine = check_for_browsers(version.layout().vertex_count(), web::max_vertices); !fine)
      return fine;
    streams_.prepare(stream_for(version.layout()));
    next_model_ = message_for(version.layout(), version.mesh);
    return {};
  }
  Result<void> settle() override {
    if (streams_.settle()) server_->present(streams_.now(), std::move(next_model_), pictures_);
    return {};
  }
  void update(const RunStatus& status, Asks& asks) override {
    server_->set_settings(status.frame.settings);
    server_->set_commands(status.situation());
    server_->follow(status.frame, status.puppet.get());
    update_weights();
    panel_.pending.follow(status.frame.settings);
    show_panel(status);
    while (auto asked = server_->next_command()) {
      if (const auto* const row = std::get_if<const commands::Row*>(&*asked)) {
        panel_.ask(**row, status.situation());
        if (!panel_.note.empty()) server_->report(panel_.note, true);
      } else if (const auto* const settings = std::get_if<web::NamedSettings>(&*asked)) {
        settings->apply_to(panel_.pending.now);
      } else {
        panel_.commands.push_back(std::get<flow::Command>(*asked));
      }
      if (const auto change = panel_.pending.ask()) panel_.commands.push_back(*change);
    }
    asks.insert(asks.end(), panel_.commands.begin(), panel_.commands.end());
    panel_.commands.clear();
  }
  void report(const Report& message) override { server_->report(message.text, message.is_error); }

private:
  void show_panel(const RunStatus& status) {
    const auto follow = [&](std::optional<web::FormInput> input) {
      panel_.follow(std::move(input), status.situation(), device_lines(status.devices),
                    status.puppet.get());
    };
    while (auto input = server_->next_input(web::FormKind::run)) {
      follow(*std::move(input));
      if (const auto change = panel_.pending.ask()) panel_.commands.push_back(*change);
    }
    const auto now = Clock::now();
    if (server_->counters().clients == 0 || now < next_panel_) return;
    next_panel_ = now + panel_period;
    follow({});
    server_->set_form(web::FormKind::run, panel_.message());
    if (now < next_status_) return;
    next_status_ = now + status_period;
    server_->set_form(web::FormKind::status,
                      web::status_message(status.frame, placed_->setup.options.rate_hz,
                                          status.model.mesh.vertex_count()));
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
  web::PagePanel panel_; ///< the panel that all clients share
  Clock::time_point next_panel_{}, next_status_{};
  std::uint64_t weights_ = 0;         ///< deform::SurfaceField::number() of the last weights
  web::Pictures pictures_;            ///< the textures of all versions of the model
  std::vector<std::byte> next_model_; ///< the message of the last prepared version
  const PlacedLoop* placed_ = nullptr;
  std::string model_name_; ///< the name on the page
};

} // namespace

forms::DeviceLines device_lines(const gloves::DeviceStatuses& devices) {
  forms::DeviceLines lines;
  for (std::size_t slot = 0; slot < devices.size(); ++slot)
    for (const auto& [title, state] : devices[slot])
      lines[slot].insert(lines[slot].end(), {title, state});
  return lines;
}

Result<void> check_for_browsers(std::size_t vertices, std::size_t most) {
  if (vertices <= most) return {};
  return Error{Errc::bad_input, "--web: the model has " + std::to_string(vertices) +
                                    " vertices, and a browser takes at most " +
                                    std::to_string(most) +
                                    "; run it without --web, or reduce the model"};
}

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
