// The first byte chooses what the rest is: a request's head, what a client sends over its
// WebSocket, in chunks, or the words in it.

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include <nendo/base/text.hpp>

#include "commands/command_text.hpp"
#include "laws.hpp"
#include "web/client_commands.hpp"
#include "web/foxglove_feed.hpp"
#include "web/http_request.hpp"
#include "web/model_message.hpp"
#include "web/web_socket.hpp"

using namespace nendo::web;

namespace {

bool is_within(std::string_view part, std::string_view whole) {
  return part.empty() ||
         (part.data() >= whole.data() && part.data() + part.size() <= whole.data() + whole.size());
}

void check_head(std::string_view bytes) {
  const HttpHead head = parse_head(bytes);
  require(head.bytes <= std::min(bytes.size(), max_head_bytes));
  require(head.status != 200 || head.body_bytes <= max_file_bytes);
  if (head.status != 200) return;
  require(bytes.substr(head.bytes - 4, 4) == "\r\n\r\n");
  require(head.request.headers.size() <= max_headers);
  for (const auto& [name, value] : head.request.headers)
    require(!name.empty() && is_within(name, bytes) && is_within(value, bytes));
  const Admission admission = admit(head.request, "0123456789abcdef0123456789abcdef");
  require(admission.status == 200 || !admission.why.empty());
  const auto number = picture_number(head.request.parameter("number").value_or(""));
  require(!number || *number <= 999'999'999);
  const bool needs_token = admission.status == 200 && admission.resource != Resource::page;
  require(!needs_token || head.request.query.find("0123456789abcdef") != std::string_view::npos);
}

void check_frames(std::string_view bytes, std::size_t chunk) {
  ClientReader reader;
  std::string waiting;
  std::size_t told = 0;
  bool failed = false;
  for (std::size_t at = 0; at < bytes.size() && !failed; at += chunk) {
    waiting += bytes.substr(at, chunk);
    for (auto event = reader.next(waiting); event.kind != ClientEvent::Kind::nothing;
         event = reader.next(waiting)) {
      require(!failed && event.payload.size() <= max_client_message);
      failed = event.kind == ClientEvent::Kind::fault;
      told += event.payload.size();
    }
    require(failed || waiting.size() < ClientReader::max_pending);
  }
  require(told <= bytes.size());
}

// A loop takes them, and their text means the same.
void check_settings(const NamedSettings& named) {
  nendo::flow::LoopSettings settings;
  settings.radius_m.fill(1.0);
  named.apply_to(settings);
  require(settings.are_usable());
  const auto again = parse_named_settings(nendo::commands::text_of(settings));
  require(static_cast<bool>(again));
  nendo::flow::LoopSettings read;
  again->apply_to(read);
  require(read == settings);
}

// Whatever is understood is something that a loop may be asked for.
void check_words(std::string_view text) {
  if (const auto input = parse_form_input(text)) {
    require(!input->control.empty() && input->control.size() + input->value.size() < text.size());
    if (const auto& pointer = input->pointer)
      for (const double number : {pointer->x, pointer->y, pointer->panned, pointer->wheel})
        require(std::abs(number) <= PointerInput::max_number);
  }
  if (const auto name = file_name_in(text))
    require(!name->empty() && name->front() != '.' && name->find('/') == std::string::npos);
  const auto asked = parse_command(text);
  require(asked || asked.error().message.size() <= max_close_reason);
  if (!asked) return;
  require(text.front() != ' ' && text.back() != ' ');
  if (const auto* const named = std::get_if<NamedSettings>(&*asked)) return check_settings(*named);
  const auto* const command = std::get_if<nendo::flow::Command>(&*asked);
  if (command == nullptr) return; // a row of the table
  if (const auto* move = std::get_if<nendo::flow::WristMove>(command)) {
    const Eigen::Isometry3d pose = move->pose();
    require(move->is_usable() && pose.matrix().allFinite());
    require(std::abs(pose.linear().determinant() - 1.0) < 1e-9);
  }
  if (const auto* mask = std::get_if<nendo::flow::SetMask>(command)) require(mask->is_usable());
}

// A client's subscriptions, one request a line, against a list of them that is kept here.
void check_foxglove(std::string_view text) {
  const FoxgloveMessages messages; // of a run without a model: channels 1 to 3
  FoxgloveFeed feed;
  std::set<std::uint32_t> ids;
  while (!text.empty()) {
    const auto request = parse_foxglove(nendo::cut(text, '\n'));
    require(request || request.error().message.size() <= max_close_reason);
    if (!request) continue;
    std::size_t refused = 0;
    for (const auto& [id, channel] : request->subscribe) {
      const bool fits =
          channel >= 1 && channel <= 3 && ids.size() < FoxgloveFeed::max_subscriptions;
      if (!fits || !ids.insert(id).second) ++refused;
    }
    for (const std::uint32_t id : request->unsubscribe)
      ids.erase(id);
    require(feed.take(*request, messages).size() == refused);
  }
}

} // namespace

// NOLINTNEXTLINE(readability-identifier-naming): libFuzzer calls it by this name
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string_view rest(reinterpret_cast<const char*>(data) + 1, size - 1);
  if (*data == 255)
    check_foxglove(rest);
  else if (*data % 4 == 0)
    check_head(rest);
  else if (*data % 4 == 2)
    check_words(rest);
  else
    check_frames(rest, 1 + *data % 11);
  return 0;
}
