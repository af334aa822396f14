#include "session/web_outlet.hpp"

#include <filesystem>

#include <nendo/web/model_message.hpp>

#include "cli/cli.hpp"
#include "session/loop_change.hpp"

namespace nendo::session {
namespace {

// Gloves are asked under a lock of theirs, so not more often than anybody looks.
constexpr std::chrono::milliseconds look_period(250);

} // namespace

Result<void> WebOutlet::begin(const PlacedLoop& placed, const deform::Mesh& model,
                              const std::vector<gloves::OpenHand>& hands) {
  const auto& options = placed.setup.options;
  const auto& layout = placed.loop->layout();
  if (layout.vertex_count() > web::most_vertices)
    return Error{Errc::bad_input, "--web: the model has " + std::to_string(layout.vertex_count()) +
                                      " vertices, and a browser takes " +
                                      std::to_string(web::most_vertices) +
                                      " at most; run it without --web, or thin it out"};
  hands_ = &hands;
  const FrameRoom room = room_of_frames(placed);
  tap_ = std::make_shared<web::FrameStream>(layout, options.sculptor.mode, room.fields,
                                            room.functions);
  server_->present(
      tap_, web::model_message(layout, model, placed.setup.inputs,
                               {name, options.rate_hz, placed.setup.placement.units_per_metre,
                                settings_of(placed), placed.recorded}));
  return {};
}

std::optional<flow::Request> WebOutlet::next_request() {
  if (HostClock::now() >= next_look_ && hands_ != nullptr) {
    next_look_ = HostClock::now() + look_period;
    std::array<std::uint32_t, 2> bad{};
    for (const gloves::OpenHand& hand : *hands_)
      bad[flow::Placement::index_of(hand.side)] =
          static_cast<std::uint32_t>(hand.glove->stats().bad_records);
    server_->tell_bad_records(bad);
  }
  return server_->next_request();
}

Result<std::unique_ptr<WebOutlet>> open_web(const std::string& endpoint, const std::string& mesh) {
  const auto where = web::parse_endpoint(endpoint);
  if (!where) return where.error();
  auto server = web::Server::open(*where);
  if (!server) return server.error();
  cli::note("to look on, open " + (*server)->url());
  const std::string& address = (*server)->endpoint().address;
  if (address == "0.0.0.0" || address == "::")
    cli::note("from another machine, with this one's address in place of " + address +
              "; who is on the network can read along, for nothing is encrypted");
  auto outlet = std::make_unique<WebOutlet>(*std::move(server));
  outlet->name = std::filesystem::path(mesh).filename().string();
  return outlet;
}

} // namespace nendo::session
