#pragma once
// The places that `--to` can name.

#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include <nendo/base/endpoint.hpp>
#include <nendo/base/result.hpp>

namespace nendo::publish {

struct SegmentTarget {
  std::string name;              ///< the NAME of /dev/shm/nendo-NAME
  std::optional<unsigned> group; ///< that may also read it
};

/// nendo: messages of this project, which apps/publish/OSC.md lists. vmc: the bones of an avatar.
enum class OscFormat { nendo, vmc };

struct OscTarget {
  OscFormat format = OscFormat::nendo;
  std::optional<double> rate_hz; ///< max; nothing: each tick
  Endpoint endpoint;
};

/// The endpoint at which a VRPN server listens.
struct VrpnTarget {
  std::optional<double> rate_hz; ///< max; nothing: each tick
  Endpoint endpoint;
};

using Target = std::variant<SegmentTarget, OscTarget, VrpnTarget>;

/// Parses `shm`, `shm:NAME` or `shm:NAME?group=GROUP`; or `osc:PORT` (of this machine),
/// `osc:ADDRESS:PORT` with a numeric address, or `osc:[ADDRESS]:PORT` with an IPv6 address, all of
/// them also with `?rate=HZ`; or the same with `vmc` or `vrpn`; or `vrpn`, which is VRPN's port of
/// this machine. It looks up only the group. Error: usage, in
/// a message without the name of the option.
Result<Target> parse_target(std::string_view text);

/// Returns whether both are the same segment, or the same address and port to which something is
/// sent or at which a server listens.
bool is_same_place(const Target& one, const Target& other) noexcept;

} // namespace nendo::publish
