#pragma once
// Tells systemd how a service fares, by its protocol (sd_notify(3)): datagrams to the socket that
// the environment names. Outside a service nothing is sent.

#include <string>
#include <string_view>

namespace nendo::service {

class ServiceNotice {
public:
  /// Reads NOTIFY_SOCKET, and takes it out of the environment: it is not for child processes.
  ServiceNotice();
  /// STOPPING=1, if it was ready.
  ~ServiceNotice();
  ServiceNotice(const ServiceNotice&) = delete;
  ServiceNotice& operator=(const ServiceNotice&) = delete;

  /// A frame came: READY=1 the first time, and each time WATCHDOG=1. To be called several times
  /// within the service's WatchdogSec. Never blocks: a notice that finds no room is left out.
  void alive() noexcept;

private:
  void send(std::string_view text) const noexcept;

  std::string socket_path_; ///< empty: no service
  int socket_ = -1;
  bool ready_ = false;
};

} // namespace nendo::service
