#include "publish/vrpn_publisher.hpp"

namespace nendo::publish {

Result<void> VrpnPublisher::begin(const LoopOutline& /*outline*/) {
  end();
  if (!server_) {
    auto opened = vrpn::Server::open(endpoint_);
    if (!opened) return Error{opened.error().code, "--to " + name_ + ": " + opened.error().message};
    server_.emplace(*std::move(opened));
  }
  sender_.begin([this](const HandsRecord& record) { server_->send(record); },
                [this] { server_->serve(); });
  return {};
}

VrpnCounts VrpnPublisher::counts() const {
  VrpnCounts all;
  static_cast<SenderCounts&>(all) = sender_.counts();
  if (server_) static_cast<vrpn::ServerCounts&>(all) = server_->counts();
  return all;
}

} // namespace nendo::publish
