// Reading timelines.

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include "config/toml_reader.hpp"
#include "timeline/timeline_file.hpp"

namespace nendo::timeline {

using config::TomlReader;

namespace {

deform::Support read_support(TomlReader& reader, const toml::node& node) {
  const auto values = reader.numbers<2>(node, "a shared support");
  return {values[0], values[1]};
}

void read_supports(TomlReader& reader, const toml::table& table, deform::Supports& supports) {
  supports = {};
  constexpr std::size_t most_supports = 64;
  const toml::array* const shared = reader.array(table, "shared");
  const toml::array* const own = reader.array(table, "own");
  if (shared == nullptr || own == nullptr) return;
  if (shared->size() > most_supports || own->size() > most_supports)
    return reader.complain(table, "there are more than 64 supports of a kind");
  for (const toml::node& node : *shared)
    supports.shared.push_back(read_support(reader, node));
  for (const toml::node& node : *own) {
    const toml::table* const one = reader.as_table(node, "an own support");
    if (one == nullptr) return;
    reader.allow_only(*one, {"tip", "radius", "weight"});
    const auto tip = static_cast<Eigen::Index>(reader.count(*one, "tip", 9));
    supports.own.push_back({tip, {reader.number(*one, "radius"), reader.number(*one, "weight")}});
  }
}

void read_injective(TomlReader& reader, const toml::table& table,
                    deform::DeformerOptions& options) {
  if (table.get("injective") == nullptr) return;
  const toml::table* const injective = reader.table(table, "injective");
  if (injective == nullptr) return;
  reader.allow_only(*injective, {"most_bound", "most_links", "least_gap"});
  options.injective.emplace();
  options.injective->most_bound = reader.number(*injective, "most_bound");
  options.injective->most_links = static_cast<int>(reader.count(*injective, "most_links", 1024));
  options.injective->least_gap = reader.number(*injective, "least_gap");
}

/// Older files have none.
void read_brushes(TomlReader& reader, const toml::table& table,
                  std::array<deform::Brush, 5>& brushes, double& strength) {
  if (table.get("brush_strength") != nullptr) strength = reader.number(table, "brush_strength");
  const toml::node* const node = table.get("brushes");
  if (node == nullptr) return;
  const toml::array* const names = node->as_array();
  if (names == nullptr || names->size() != brushes.size())
    return reader.complain(*node, "brushes must be five names, thumb to little finger");
  for (std::size_t finger = 0; finger < brushes.size(); ++finger) {
    const auto name = (*names)[finger].value<std::string>();
    const auto brush = name ? deform::brush_named(*name) : std::nullopt;
    if (!brush) return reader.complain((*names)[finger], "this is no brush");
    brushes[finger] = *brush;
  }
}

void read_sculptor(TomlReader& reader, const toml::table& root, flow::SculptorOptions& sculptor) {
  const toml::table* const table = reader.table(root, "sculptor");
  if (table == nullptr) return;
  // order and storage stand in older files; they are ignored.
  reader.allow_only(*table, {"mode", "piece_length", "kernel", "polynomial", "merge_fraction",
                             "order", "storage", "weight_bytes", "shared", "own", "injective",
                             "brushes", "brush_strength"});
  auto& options = sculptor.deformer;
  read_brushes(reader, *table, sculptor.brushes, sculptor.brush_strength);
  sculptor.mode = reader.named(*table, "mode", flow::mode_named);
  sculptor.piece_length = reader.number(*table, "piece_length");
  options.csrbf.kernel = reader.named(*table, "kernel", deform::wendland_named);
  options.csrbf.polynomial = reader.named(*table, "polynomial", deform::polynomial_named);
  options.csrbf.merge_fraction = reader.number(*table, "merge_fraction");
  options.evaluation.weight_bytes =
      reader.count(*table, "weight_bytes", std::numeric_limits<std::int64_t>::max());
  read_supports(reader, *table, options.supports);
  read_injective(reader, *table, options);
}

Key read_key(TomlReader& reader, const toml::table& table) {
  reader.allow_only(table, {"time_s", "wrist_m", "wrist_turn", "angles_rad"});
  Key key;
  key.time_s = reader.number(table, "time_s");
  const toml::node* const place = reader.find(table, "wrist_m");
  const toml::node* const turn = reader.find(table, "wrist_turn");
  const toml::table* const angles = reader.table(table, "angles_rad");
  if (place == nullptr || turn == nullptr || angles == nullptr) return key;
  const auto place_m = reader.numbers<3>(*place, "wrist_m");
  key.wrist_m = {place_m[0], place_m[1], place_m[2]};
  const auto parts = reader.numbers<4>(*turn, "wrist_turn");
  key.wrist_turn = {parts[0], parts[1], parts[2], parts[3]};
  for (std::size_t at = 0; at < hand::angle_count; ++at)
    key.angles[hand::angle_at(at)] = reader.number(*angles, hand::angle_names[at]);
  if (angles->size() > hand::angle_count)
    reader.complain(*angles, "angles_rad has an angle that no hand has; `nendo edit show --json` "
                             "names them");
  if (const std::string wrong = complaint_about(key); !wrong.empty()) reader.complain(table, wrong);
  return key;
}

std::optional<Side> side_named(std::string_view name) {
  if (name == "left") return Side::left;
  if (name == "right") return Side::right;
  return std::nullopt;
}

HandTrack read_hand(TomlReader& reader, const toml::table& table) {
  reader.allow_only(table, {"side", "length_m", "breadth_m", "keys"});
  HandTrack hand;
  hand.side = reader.named(table, "side", side_named);
  hand.size = {reader.number(table, "length_m"), reader.number(table, "breadth_m")};
  const toml::array* const keys = reader.array(table, "keys");
  if (keys == nullptr) return hand;
  for (const toml::node& node : *keys) {
    const toml::table* const key = reader.as_table(node, "a key");
    if (key == nullptr || reader.error()) return hand;
    hand.keys.push_back(read_key(reader, *key));
  }
  return hand;
}

flow::LoopSettings read_settings(TomlReader& reader, const toml::table& event) {
  flow::LoopSettings settings;
  if (event.get("request") != nullptr)
    reader.complain(event, "an event has a request or settings; make two events of it");
  const toml::table* const table = reader.table(event, "settings");
  if (table == nullptr) return settings;
  reader.allow_only(*table, {"mode", "kernel", "injective", "radius_m", "piece_fraction", "brushes",
                             "brush_strength"});
  read_brushes(reader, *table, settings.brushes, settings.brush_strength);
  settings.mode = reader.named(*table, "mode", flow::mode_named);
  settings.kernel = reader.named(*table, "kernel", deform::wendland_named);
  settings.injective = reader.truth(*table, "injective");
  if (const toml::node* const radii = reader.find(*table, "radius_m"))
    settings.radius_m = reader.numbers<5>(*radii, "radius_m");
  settings.piece_fraction = reader.number(*table, "piece_fraction");
  return settings;
}

void read_events(TomlReader& reader, const toml::table& root, Timeline& timeline) {
  const toml::array* const events = reader.array(root, "events");
  if (events == nullptr) return;
  for (const toml::node& node : *events) {
    const toml::table* const event = reader.as_table(node, "an event");
    if (event == nullptr || reader.error()) return;
    reader.allow_only(*event, {"time_s", "request", "settings"});
    Event& read = timeline.events.emplace_back();
    read.time_s = reader.number(*event, "time_s");
    if (event->get("settings") != nullptr)
      read.settings = read_settings(reader, *event);
    else if (event->get("request") != nullptr &&
             event->at("request").value<std::string_view>() == "subdivide")
      read.subdivides = true;
    else
      read.request = reader.named(*event, "request", flow::request_named);
  }
}

void read_model(TomlReader& reader, const toml::table& root, Timeline& timeline) {
  const toml::table* const model = reader.table(root, "model");
  if (model == nullptr) return;
  reader.allow_only(*model, {"file", "vertices", "crc32c"});
  timeline.mesh = reader.text(*model, "file");
  timeline.mesh_sum.vertices =
      reader.count(*model, "vertices", std::numeric_limits<std::int64_t>::max());
  timeline.mesh_sum.crc = static_cast<std::uint32_t>(
      reader.count(*model, "crc32c", std::numeric_limits<std::uint32_t>::max()));
}

Timeline read_root(TomlReader& reader, const toml::table& root) {
  reader.allow_only(root, {"version", "take", "units_per_metre", "rate_hz", "duration_s", "held",
                           "pull_is_step", "events", "model", "sculptor", "hands"});
  Timeline timeline;
  timeline.take = reader.text(root, "take");
  timeline.units_per_metre = reader.number(root, "units_per_metre");
  timeline.rate_hz = reader.number(root, "rate_hz");
  timeline.duration_s = reader.number(root, "duration_s");
  timeline.held = reader.truth(root, "held");
  timeline.pull_is_step = root.contains("pull_is_step") && reader.truth(root, "pull_is_step");
  read_events(reader, root, timeline);
  read_model(reader, root, timeline);
  read_sculptor(reader, root, timeline.sculptor);
  const toml::array* const hands = reader.array(root, "hands");
  if (hands == nullptr) return timeline;
  for (const toml::node& node : *hands) {
    const toml::table* const hand = reader.as_table(node, "a hand");
    if (hand == nullptr || reader.error()) break;
    timeline.hands.push_back(read_hand(reader, *hand));
  }
  if (const std::string wrong = complaint_about(timeline); !wrong.empty())
    reader.complain(root, wrong);
  return timeline;
}

} // namespace

Result<Timeline> parse_timeline(std::string_view text, std::string_view name) {
  Timeline timeline;
  const auto error =
      config::read_toml(text, name, [&](TomlReader& reader, const toml::table& root) {
        timeline = read_root(reader, root);
      });
  if (error) return *error;
  return timeline;
}

} // namespace nendo::timeline
