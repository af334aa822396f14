#include <algorithm>
#include <string>

#include <nendo/hand/tracker_mount.hpp>

#include "config/toml_reader.hpp"
#include "mount_check.hpp"

namespace nendo::hand {

using config::TomlReader;

namespace {

template <std::size_t Size>
std::array<double, Size> read_numbers(TomlReader& reader, const toml::table& root,
                                      std::string_view key) {
  const toml::node* const node = reader.find(root, key);
  return node == nullptr ? std::array<double, Size>{} : reader.numbers<Size>(*node, key);
}

/// Reads one of two words. Returns whether it is the second one.
bool read_choice(TomlReader& reader, const toml::table& root, std::string_view key,
                 std::string_view first, std::string_view second) {
  const std::string word = reader.text(root, key);
  const toml::node* const node = root.get(key);
  if (node != nullptr && word != first && word != second)
    reader.complain(*node, std::string(key) + " " + in_quotes(word) + ": must be \"" +
                               std::string(first) + "\" or \"" + std::string(second) + "\"");
  return word == second;
}

/// Returns the key with which a complaint begins.
std::string_view key_of(std::string_view complaint) {
  return complaint.substr(0, complaint.find(' '));
}

void read_keys(TomlReader& reader, const toml::table& root, TrackerMount& mount) {
  reader.allow_only(root,
                    {"version", "tracker", "station", "side", "mounted", "position_mm", "turn_xyzw",
                     "stage_from_tracker_xyzw", "late_ms", "residual_mm", "taken"});
  mount.tracker = reader.text(root, "tracker");
  mount.station = static_cast<std::uint16_t>(reader.count(root, "station", 65535));
  mount.side = read_choice(reader, root, "side", "left", "right") ? Side::right : Side::left;
  mount.on_hand = read_choice(reader, root, "mounted", "forearm", "hand");
  mount.position_mm = read_numbers<3>(reader, root, "position_mm");
  mount.turn_xyzw = read_numbers<4>(reader, root, "turn_xyzw");
  mount.stage_from_tracker_xyzw = read_numbers<4>(reader, root, "stage_from_tracker_xyzw");
  mount.late_ms = reader.number(root, "late_ms");
  mount.residual_mm = reader.number(root, "residual_mm");
  mount.taken = reader.time(root, "taken");
  const std::string complaint = complaint_about(mount);
  if (complaint.empty()) return;
  const toml::node* const node = root.get(key_of(complaint));
  reader.complain(node != nullptr ? *node : root, complaint);
}

} // namespace

Result<TrackerMount> parse_mount(std::string_view text, std::string_view name) {
  TrackerMount mount;
  const auto error = config::read_toml(
      text, name,
      [&](TomlReader& reader, const toml::table& root) { read_keys(reader, root, mount); },
      "fix it or calibrate the tracker again");
  if (error) return *error;
  return mount;
}

} // namespace nendo::hand
