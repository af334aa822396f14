#include "served/served_dialogue.hpp"

#include <array>
#include <chrono>
#include <span>
#include <utility>

#include <spdlog/spdlog.h>

#include <nendo/base/shared_name.hpp>
#include <nendo/base/text.hpp>
#include <nendo/driver/glove_options.hpp>
#include <nendo/driver/serve_place.hpp>

#include "stream/listen.hpp"

namespace nendo::driver::served {
namespace {

using namespace std::chrono_literals;

constexpr auto write_timeout = 100ms;
constexpr auto answer_time = 1000ms; ///< a server answers within a millisecond

IoStatus say(Transport& transport, std::string_view request) noexcept {
  return transport.write_all(std::as_bytes(std::span(request)), write_timeout);
}

template <class DeviceLine>
void add_line(std::vector<DeviceLine>& lines, const DeviceLine& line) {
  if (lines.size() < max_devices) lines.push_back(line);
}

} // namespace

Result<ServePlace> parse_serve_place(const DeviceSpec& spec) {
  if (auto allowed = allow_options(spec, {"hand"}); !allowed) return allowed.error();
  const auto hand = hand_option(spec);
  if (!hand) return hand.error();
  const std::string_view name = spec.target.empty() ? default_serve_name : spec.target;
  if (!is_shared_name(name))
    return Error{Errc::usage, spec.text + ": " + std::string(shared_name_rule)};
  const ServeFolders folders = serve_folders();
  std::vector<std::string> paths;
  for (const std::string& folder : {folders.own, folders.services})
    if (!folder.empty()) paths.push_back(serve_socket(folder, name));
  return ServePlace{spec.text, std::make_shared<UnixConnector>(spec.text, std::move(paths)), *hand};
}

Error ServedDialogue::problem(const std::string& what) const {
  return {Errc::no_device,
          place_.source + ": the program at " + printable(place_.server->path()) + " " + what};
}

void ServedDialogue::hear(std::span<const std::byte> chunk) {
  parser_.push(chunk, FindingSink{[&](const VersionLine& line) { version_ = line; },
                                  [&](const GloveLine& line) { add_line(gloves_, line); },
                                  [&](const TrackerLine& line) { add_line(trackers_, line); },
                                  [&](const WatchLine& line) { has_answered_ = !line.samples; },
                                  [&](const ErrorLine& line) { refusal_ = line.message; }});
}

Result<void> ServedDialogue::ask(Transport& transport, const ReplyDeadline& limit) {
  parser_.want({});
  explain_clock();
  if (connection_ != place_.server->connections()) {
    connection_ = place_.server->connections();
    parser_.reset();
    version_.reset();
    gloves_.clear();
    trackers_.clear();
  }
  refusal_.clear();
  has_answered_ = false;
  const std::uint64_t bytes_before = parser_.counters().bytes;
  const std::uint64_t bad_before = parser_.counters().bad_records;
  const auto is_stranger = [&] { return !version_ && parser_.counters().bad_records > bad_before; };
  IoStatus status = say(transport, watch_nothing);
  // A server that refuses says why, and goes away.
  const IoStatus heard =
      listen(transport, limit, answer_time, [&](std::span<const std::byte> chunk) {
        hear(chunk);
        return has_answered_ || !refusal_.empty() || is_stranger();
      });
  if (status == IoStatus::done || heard == IoStatus::gone) status = heard;
  const bool is_known = version_ && version_->protocol == protocol_number;
  if (has_answered_ && is_known && refusal_.empty()) return {};
  transport.hang_up();
  return unanswered(status, parser_.counters().bytes - bytes_before);
}

Error ServedDialogue::unanswered(IoStatus status, std::uint64_t bytes_heard) const {
  if (!refusal_.empty()) return problem("refuses: " + in_quotes(refusal_));
  if (version_ && version_->protocol != protocol_number)
    return problem("speaks protocol " + std::to_string(version_->protocol) + " (Nendo " +
                   version_->version + "), but this one " + std::to_string(protocol_number) +
                   "; use programs of one version");
  if (status == IoStatus::gone) return problem("closed the connection; is it restarted?");
  if (bytes_heard == 0)
    return problem("accepts the connection and says nothing; is it stuck? Restart it");
  return problem("does not answer as `nendo serve` does; is it another program's socket?");
}

/// Where each sample is bad, the user cannot see why.
void ServedDialogue::explain_clock() {
  if (parser_.counters().implausible == 0 || std::exchange(has_explained_clock_, true)) return;
  spdlog::warn(
      "device: {}: the server's clock is not this program's; is one of them in a container "
      "with its own time?",
      place_.source);
}

void ServedDialogue::start(Transport& transport, const WantedDevice& device,
                           const ReplyDeadline& limit) {
  std::array<std::byte, 4096> buffer;
  IoStatus status = IoStatus::done;
  while (status == IoStatus::done && HostClock::now() < limit.deadline) {
    const ReadResult read = transport.read_some(buffer, 0ms);
    status = read.status;
    hear(std::span<const std::byte>(buffer).first(read.count));
  }
  parser_.want(device);
  say(transport, watch_samples); // one that is gone is connected again by the reader
}

void ServedDialogue::end(Transport& transport) noexcept {
  say(transport, watch_nothing);
}

std::vector<DeviceFact> ServedDialogue::facts(const std::string& source) const {
  return {{"server", printable(place_.server->path())},
          {"server_version", version_ ? version_->version : ""},
          {"server_source", source}};
}

} // namespace nendo::driver::served
