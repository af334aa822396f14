// The input is what a client of the VRPN server sends, in chunks whose length its first byte
// chooses.

#include "publish/vrpn_messages.hpp"
#include "publish/vrpn_requests.hpp"
#include "publish/vrpn_server.hpp"

#include <vector>

#include "parser_fuzz.hpp"

using namespace nendo::publish::vrpn;

// NOLINTNEXTLINE(readability-identifier-naming): libFuzzer calls it by this name
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 2) return 0;
  const auto bytes = rest_of({data, size});
  const std::uint16_t port = asked_port(bytes);
  require(port == 0 || port >= 1024);
  Requests cut, whole;
  std::vector<std::size_t> cut_pings, whole_pings;
  const std::size_t longest = 1 + data[0];
  bool is_readable = true;
  for (auto rest = bytes; !rest.empty();) {
    const auto chunk = rest.first(std::min(longest, rest.size()));
    rest = rest.subspan(chunk.size());
    is_readable = cut.push(chunk, cut_pings);
    require(cut.held_bytes() < Requests::max_held_bytes);
  }
  require(whole.push(bytes, whole_pings) == is_readable);
  require(cut_pings == whole_pings);
  for (const std::size_t sender : whole_pings)
    require(sender < sender_names.size());
  return 0;
}
