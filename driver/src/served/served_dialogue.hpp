#pragma once
// The conversation with `nendo serve`, which is the same for gloves and trackers.

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/base/side.hpp>
#include <nendo/base/text.hpp>
#include <nendo/driver/device_spec.hpp>

#include "served/served_parser.hpp"
#include "stream/stream_protocol.hpp"
#include "transport/transport.hpp"
#include "transport/unix_transport.hpp"

namespace nendo::driver::served {

/// A `serve:` specification.
struct ServePlace {
  std::string source; ///< as typed
  std::shared_ptr<UnixConnector> server;
  std::optional<Side> hand; ///< the option `hand`
};

/// Parses `serve[:NAME][?hand=left|right]`. Reads the environment. Error: usage.
Result<ServePlace> parse_serve_place(const DeviceSpec& spec);

/// One thread at a time uses it, as it uses a StreamProtocol.
class ServedDialogue {
public:
  explicit ServedDialogue(ServePlace place) : place_(std::move(place)) {}

  /// Stops samples, and, in a new connection, takes what the server says of itself and its devices.
  /// Error: no_device; hangs up then.
  Result<void> ask(Transport& transport, const ReplyDeadline& limit);
  /// Asks for samples of that device. What arrived earlier is not delivered.
  void start(Transport& transport, const WantedDevice& device, const ReplyDeadline& limit);
  /// Asks for no more samples. The connection stays.
  void end(Transport& transport) noexcept;

  const ServePlace& place() const noexcept { return place_; }
  const std::vector<GloveLine>& gloves() const noexcept { return gloves_; }
  const std::vector<TrackerLine>& trackers() const noexcept { return trackers_; }
  /// Returns the facts of the server, and of a device that the server opened as `source`.
  std::vector<DeviceFact> facts(const std::string& source) const;
  Parser& parser() noexcept { return parser_; }
  const Parser& parser() const noexcept { return parser_; }

private:
  Error problem(const std::string& what) const;
  void hear(std::span<const std::byte> chunk);
  Error unanswered(IoStatus status, std::uint64_t bytes_heard) const;
  void explain_clock();

  const ServePlace place_;
  std::uint64_t connection_ = 0; ///< the number of the connection whose server was met
  std::optional<VersionLine> version_;
  std::vector<GloveLine> gloves_;     ///< the first ones
  std::vector<TrackerLine> trackers_; ///< the first ones
  std::string refusal_;               ///< the server's last error
  bool has_answered_ = false;
  bool has_explained_clock_ = false;
  Parser parser_;
};

/// Returns the line of the device that moves the wanted hand, or of the only one. `noun` is "glove"
/// or "tracker". Errors: no_device (there is none), usage (there are two, and no hand is wanted).
template <class DeviceLine>
Result<DeviceLine> device_of(const std::vector<DeviceLine>& lines, std::optional<Side> wanted,
                             const std::string& source, const std::string& noun) {
  const DeviceLine* found = nullptr;
  std::string list;
  bool has_both = false;
  for (const DeviceLine& line : lines) {
    list += (list.empty() ? "" : ", ") + std::string(name_of(line.side)) + " (" +
            in_quotes(line.info.model) + ")";
    if (wanted && line.side != *wanted) continue;
    has_both = has_both || (found != nullptr && found->side != line.side);
    if (found == nullptr) found = &line; // a second one of the same hand is a layer over it
  }
  if (found != nullptr && !has_both) return *found;
  if (has_both)
    return Error{Errc::usage, source + ": the server has " + noun + "s of both hands: " + list +
                                  "; add ?hand=left or ?hand=right"};
  if (lines.empty())
    return Error{Errc::no_device, source + ": the server has no " + noun +
                                      "; name one when you "
                                      "start it"};
  return Error{Errc::no_device, source + ": the server has no " + std::string(name_of(*wanted)) +
                                    " " + noun + "; it has: " + list + "; hand= takes another one"};
}

} // namespace nendo::driver::served
