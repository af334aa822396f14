#pragma once
// Reports the state of a service to systemd by sd_notify(3): it sends datagrams to the socket that
// the environment names. Outside a service nothing is sent.

#include <string>
#include <string_view>

namespace nendo::service {

class ServiceNotice {
public:
  /// Reads NOTIFY_SOCKET and removes it from the environment, because it is not for child
  /// processes.
  ServiceNotice();
  /// Sends STOPPING=1, if READY=1 was sent.
  ~ServiceNotice();
  ServiceNotice(const ServiceNotice&) = delete;
  ServiceNotice& operator=(const ServiceNotice&) = delete;

  /// Reports that a frame came: sends WATCHDOG=1, and READY=1 the first time. It must be called
  /// several times within the service's WatchdogSec. Never blocks: a notice that does not fit is
  /// dropped.
  void alive() noexcept;

private:
  void send(std::string_view text) const noexcept;

  std::string socket_path_; ///< empty: no service
  int socket_ = -1;
  bool ready_ = false;
};

} // namespace nendo::service
