#include "serve/request.hpp"

#include <nlohmann/json.hpp>

namespace nendo::serve {
namespace {

using Json = nlohmann::json;

constexpr int max_depth = 8;

Json parse_shallow(std::string_view text) {
  bool is_shallow = true;
  const auto watch = [&](int depth, Json::parse_event_t, Json&) {
    is_shallow = is_shallow && depth <= max_depth;
    return is_shallow;
  };
  Json parsed = Json::parse(text.begin(), text.end(), watch, false);
  return is_shallow ? parsed : Json();
}

Error refused(const char* why) {
  return {Errc::bad_input, why};
}

/// Returns false if the member is there and no boolean.
bool take_flag(const Json& object, const char* key, bool& out) {
  const auto found = object.find(key);
  if (found == object.end()) return true;
  if (found->is_boolean()) out = found->get<bool>();
  return found->is_boolean();
}

} // namespace

Result<Watch> changed(const Watch& watch, std::string_view request) {
  const Json object = parse_shallow(request);
  if (!object.is_object()) return refused("a request is a JSON object in a line");
  const auto name = object.find("class");
  if (name == object.end() || !name->is_string() || name->get_ref<const std::string&>() != "WATCH")
    return refused("the class of a request is \"WATCH\"");
  Watch wanted = watch;
  if (!take_flag(object, "samples", wanted.samples) || !take_flag(object, "hands", wanted.hands))
    return refused("samples and hands are true or false");
  if (const auto rate = object.find("rate_hz"); rate != object.end()) {
    const double rate_hz = rate->is_number() ? rate->get<double>() : 0.0;
    if (!(rate_hz >= min_rate_hz && rate_hz <= max_rate_hz))
      return refused("rate_hz is a number from 0.1 to 1000");
    wanted.rate_hz = rate_hz;
  }
  return wanted;
}

} // namespace nendo::serve
