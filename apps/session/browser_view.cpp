#include "session/browser_view.hpp"

#include <filesystem>

#include "cli/cli.hpp"
#include "cli/model_files.hpp"
#include "web/model_message.hpp"

namespace nendo::session {

Result<void> BrowserView::begin(const LoopStart& start) {
  placed_ = &start.placed;
  const deform::BlockLayout& layout = placed_->loop->changes().layout();
  if (auto fine = check(layout); !fine) return fine;
  streams_.begin(stream_for(layout));
  server_->set_settings(placed_->loop->changes().settings());
  pictures_ = web::pictures_of(start.model);
  server_->present(streams_.now(), message_for(layout, start.model), pictures_);
  follow_weights();
  return {};
}

Result<void> BrowserView::prepare(const flow::ModelVersion& version) {
  if (auto fine = check(version.layout()); !fine) return fine;
  streams_.prepare(stream_for(version.layout()));
  next_model_ = message_for(version.layout(), version.mesh);
  return {};
}

Result<void> BrowserView::settle() {
  if (streams_.settle()) server_->present(streams_.now(), std::move(next_model_), pictures_);
  return {};
}

Result<void> BrowserView::check(const deform::BlockLayout& layout) const {
  if (layout.vertex_count() <= web::max_vertices) return {};
  return Error{Errc::bad_input, "--web: the model has " + std::to_string(layout.vertex_count()) +
                                    " vertices, and a browser takes " +
                                    std::to_string(web::max_vertices) +
                                    " at most; run it without --web, or thin it out"};
}

std::shared_ptr<web::FrameStream> BrowserView::stream_for(const deform::BlockLayout& layout) const {
  const FrameCapacity most = frame_capacity(*placed_);
  return std::make_shared<web::FrameStream>(
      layout, web::FrameStream::Capacity{most.fields, most.functions, most.vectors});
}

std::vector<std::byte> BrowserView::message_for(const deform::BlockLayout& layout,
                                                const deform::Mesh& mesh) const {
  const PlacedSetup& setup = placed_->setup;
  return web::model_message(layout, mesh, setup.inputs,
                            {model_name_, setup.options.rate_hz, setup.placement.units_per_metre});
}

void BrowserView::update(const RunStatus& status, Asks& asks) {
  web::GloveStates gloves;
  for (std::size_t slot = 0; slot < gloves.size(); ++slot)
    gloves[slot] = {status.gloves[slot].counts, status.gloves[slot].uncalibrated};
  server_->set_gloves(gloves);
  server_->set_settings(status.frame.settings);
  server_->set_commands(status.situation());
  server_->set_steps(status.frame.steps);
  server_->set_puppet(status.frame.puppet, status.puppet.get());
  server_->set_clay(status.frame);
  follow_weights();
  wanted_.follow(status.frame.settings);
  while (auto asked = server_->next_command()) {
    if (const auto* const row = std::get_if<const commands::Row*>(&*asked)) {
      const commands::Answer answer = commands::press(**row, status.situation(), wanted_);
      if (answer.command) asks.emplace_back(*answer.command);
      if (answer.refusal != nullptr) server_->report(answer.refusal);
    } else if (const auto* const settings = std::get_if<web::NamedSettings>(&*asked)) {
      settings->apply_to(wanted_.now);
      if (const auto change = wanted_.ask()) asks.emplace_back(*change);
    } else {
      asks.emplace_back(std::get<flow::Command>(*asked));
    }
  }
}

// The loop makes another field of a puppet when radii, kernel or model change.
void BrowserView::follow_weights() {
  const auto& surface = placed_->loop->changes().sculptor_options().surface;
  if (!surface || surface->number() == weights_) return;
  weights_ = surface->number();
  server_->add_weights(weights_, web::weights_message(*surface));
}

Result<std::unique_ptr<BrowserView>> open_browser_view(const std::string& endpoint,
                                                       const std::string& mesh) {
  const auto where = web::parse_endpoint(endpoint);
  if (!where) return where.error();
  auto server = web::Server::open(*where);
  if (!server) return server.error();
  cli::note("to look on, open " + (*server)->url());
  const std::string& address = (*server)->endpoint().address;
  if (address == "0.0.0.0" || address == "::")
    cli::note("from another machine, with this one's address in place of " + address +
              "; who is on the network can read along, for nothing is encrypted");
  return std::make_unique<BrowserView>(*std::move(server), cli::short_name(mesh));
}

} // namespace nendo::session
