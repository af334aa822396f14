// Writing timelines, and files of them.

#include <nendo/timeline/timeline_file.hpp>

#include <array>
#include <charconv>
#include <cstdio>

#include <nendo/base/files.hpp>

#include "sculptor_names.hpp"

namespace nendo::timeline {
namespace {

/// The shortest decimals that read back to the same double, as TOML knows a float.
std::string number(double value) {
  std::array<char, 32> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
  std::string text(digits.data(), end);
  if (text.find_first_of(".e") == std::string::npos) text += ".0";
  return text;
}

template <class Numbers>
std::string list(const Numbers& numbers) {
  std::string text;
  for (const double value : numbers)
    text += (text.empty() ? "" : ", ") + number(value);
  return "[" + text + "]";
}

std::string toml_string(std::string_view text) {
  std::string written = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20 || byte == 0x7F) {
      char escaped[8];
      std::snprintf(escaped, sizeof escaped, "\\u%04X", unsigned{byte});
      written += escaped;
      continue;
    }
    if (c == '"' || c == '\\') written += '\\';
    written += c;
  }
  return written + "\"";
}

std::string line(std::string_view name, const std::string& value) {
  return std::string(name) + " = " + value + "\n";
}

std::string supports_text(const deform::Supports& supports) {
  std::string shared;
  for (const auto& support : supports.shared)
    shared += (shared.empty() ? "" : ", ") + list(std::array{support.radius, support.weight});
  std::string own;
  for (const auto& one : supports.own)
    own += (own.empty() ? "" : ", ") + std::string("{ tip = ") + std::to_string(one.point) +
           ", radius = " + number(one.support.radius) + ", weight = " + number(one.support.weight) +
           " }";
  return line("shared", "[" + shared + "]") + line("own", "[" + own + "]");
}

std::string sculptor_text(const flow::SculptorOptions& sculptor) {
  const auto& options = sculptor.deformer;
  const auto word = [](std::string_view name) { return toml_string(name); };
  std::string text =
      "\n[sculptor]\n" + line("mode", word(name_of(sculptor.mode))) +
      line("piece_length", number(sculptor.piece_length)) +
      line("kernel", word(name_of(options.csrbf.kernel))) +
      line("polynomial", word(name_of(options.csrbf.polynomial))) +
      line("merge_fraction", number(options.csrbf.merge_fraction)) +
      line("order", word(order_names[static_cast<std::size_t>(options.csrbf.order)])) +
      line("storage", word(storage_names[static_cast<std::size_t>(options.csrbf.storage)])) +
      line("weight_bytes", std::to_string(options.evaluation.weight_bytes)) +
      supports_text(options.supports);
  if (options.injective)
    text +=
        line("injective", "{ most_bound = " + number(options.injective->most_bound) +
                              ", most_links = " + std::to_string(options.injective->most_links) +
                              ", least_gap = " + number(options.injective->least_gap) + " }");
  return text;
}

std::string key_text(const Key& key) {
  std::string angles;
  for (std::size_t at = 0; at < hand::angle_count; ++at)
    angles += (at == 0 ? "" : ", ") + std::string(hand::angle_names[at]) + " = " +
              number(key.angles[hand::angle_at(at)]);
  const Eigen::Quaterniond& turn = key.wrist_turn;
  return "\n[[hands.keys]]\n" + line("time_s", number(key.time_s)) +
         line("wrist_m", list(std::array{key.wrist_m.x(), key.wrist_m.y(), key.wrist_m.z()})) +
         line("wrist_turn", list(std::array{turn.w(), turn.x(), turn.y(), turn.z()})) +
         line("angles_rad", "{ " + angles + " }");
}

std::string head_text(const Timeline& timeline) {
  std::string events;
  for (const Event& event : timeline.events)
    events += "  { time_s = " + number(event.time_s) +
              ", request = " + toml_string(name_of(event.request)) + " },\n";
  return "# Key poses of hands over a model; `nendo edit` works on it, and so does a text "
         "editor.\n" +
         line("version", "1") + line("take", toml_string(timeline.take)) +
         line("units_per_metre", number(timeline.units_per_metre)) +
         line("rate_hz", number(timeline.rate_hz)) +
         line("duration_s", number(timeline.duration_s)) +
         line("held", timeline.held ? "true" : "false") + "events = [\n" + events + "]\n" +
         "\n[model]\n" + line("file", toml_string(timeline.mesh)) +
         line("vertices", std::to_string(timeline.mesh_sum.vertices)) +
         line("crc32c", std::to_string(timeline.mesh_sum.crc));
}

/// As TOML has it: no byte sequences that are too long, no surrogates, nothing beyond U+10FFFF.
bool is_utf8(std::string_view text) noexcept {
  const auto byte = [text](std::size_t at) -> unsigned {
    return at < text.size() ? static_cast<unsigned char>(text[at]) : 0U;
  };
  for (std::size_t at = 0; at < text.size();) {
    const unsigned first = byte(at);
    const std::size_t length = first < 0x80 ? 1 : first < 0xE0 ? 2 : first < 0xF0 ? 3 : 4;
    if (first >= 0x80 && (first < 0xC2 || first > 0xF4)) return false;
    for (std::size_t next = 1; next < length; ++next)
      if ((byte(at + next) & 0xC0U) != 0x80U) return false;
    const unsigned second = byte(at + 1);
    if ((first == 0xE0 && second < 0xA0) || (first == 0xED && second > 0x9F) ||
        (first == 0xF0 && second < 0x90) || (first == 0xF4 && second > 0x8F))
      return false;
    at += length;
  }
  return true;
}

} // namespace

Result<std::string> timeline_text(const Timeline& timeline) {
  const auto failed = [](const std::string& what) { return Error{Errc::failed, what}; };
  if (std::string wrong = complaint_about(timeline); !wrong.empty()) return failed(wrong);
  if (!is_utf8(timeline.mesh) || !is_utf8(timeline.take))
    return failed("the name of the model's or the take's file is no UTF-8; rename it");
  std::string text = head_text(timeline) + sculptor_text(timeline.sculptor);
  for (const HandTrack& hand : timeline.hands) {
    text += "\n[[hands]]\n" + line("side", toml_string(name_of(hand.side))) +
            line("length_m", number(hand.size.length_m)) +
            line("breadth_m", number(hand.size.breadth_m));
    for (const Key& key : hand.keys) {
      text += key_text(key);
      if (text.size() > most_file_bytes)
        return failed("so many keys are too much for a file; make it with a greater --tolerance");
    }
  }
  return text;
}

Result<Timeline> read_timeline(const std::filesystem::path& path) {
  const auto text = read_file(path, most_file_bytes, "timeline");
  if (!text) return text.error();
  return parse_timeline(*text, path.string());
}

Result<void> write_timeline(const std::filesystem::path& path, const Timeline& timeline) {
  const auto text = timeline_text(timeline);
  if (!text) return Error{text.error().code, path.string() + ": " + text.error().message};
  return replace_file(path, *text);
}

bool is_timeline(const std::filesystem::path& path) {
  return path.filename().string().ends_with(file_ending);
}

} // namespace nendo::timeline
