// Reading timelines.

#include <algorithm>
#include <charconv>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include <nendo/flow/setting.hpp>

#include "config/toml_reader.hpp"
#include "timeline/timeline.hpp"

namespace nendo::timeline {

using config::TomlReader;

namespace {

deform::Support read_support(TomlReader& reader, const toml::node& node) {
  const auto values = reader.numbers<2>(node, "a shared support");
  return {values[0], values[1]};
}

/// `of_own`: "tip", or "point" of a puppet.
void read_supports(TomlReader& reader, const toml::table& table, std::string_view of_own,
                   deform::Supports& supports) {
  supports = {};
  constexpr std::size_t max_supports = puppet::Puppet::max_points;
  const toml::array* const shared = reader.array(table, "shared");
  const toml::array* const own = reader.array(table, "own");
  if (shared == nullptr || own == nullptr) return;
  if (shared->size() > max_supports || own->size() > max_supports)
    return reader.complain(table, "there are more than 1000 supports of a kind");
  for (const toml::node& node : *shared)
    supports.shared.push_back(read_support(reader, node));
  reader.each_table(*own, "an own support", [&](const toml::table& one) {
    reader.allow_only(one, {of_own, "radius", "weight"});
    const auto point = static_cast<Eigen::Index>(reader.count(one, of_own, max_supports));
    supports.own.push_back({point, {reader.number(one, "radius"), reader.number(one, "weight")}});
  });
}

void read_injective(TomlReader& reader, const toml::table& table,
                    deform::DeformerOptions& options) {
  if (table.get("injective") == nullptr) return;
  const toml::table* const injective = reader.table(table, "injective");
  if (injective == nullptr) return;
  reader.allow_only(*injective, {"most_bound", "most_links", "least_gap"});
  options.injective.emplace();
  options.injective->max_bound = reader.number(*injective, "most_bound");
  options.injective->max_links = static_cast<int>(reader.count(*injective, "most_links", 1024));
  options.injective->min_gap = reader.number(*injective, "least_gap");
}

void require_rule(TomlReader& reader, const toml::table& table, std::string_view rule) {
  if (table[rule].value<bool>() != true)
    reader.complain(table, "there is no '" + std::string(rule) +
                               " = true': a nendo before 0.2.0 made this timeline; make it again "
                               "from its recording with `nendo edit make`");
}

/// Reads a setting, which a table must have.
class SettingReader {
public:
  SettingReader(TomlReader& reader, const toml::table& table, flow::LoopSettings& settings)
      : reader_(&reader), table_(&table), settings_(&settings) {}

  template <class Setting>
  void operator()(const Setting& setting) const {
    read(setting);
  }

private:
  template <class T>
  void read(const flow::ChoiceSetting<T>& choice) const {
    choice.of(*settings_) = reader_->named(*table_, choice.name, choice.named);
  }
  void read(const flow::SwitchSetting& on) const {
    on.of(*settings_) = reader_->truth(*table_, on.name);
  }
  void read(const flow::NumberSetting& number) const {
    number.of(*settings_) = reader_->number(*table_, number.name);
  }
  void read(const flow::FingersSetting& lengths) const {
    if (const toml::node* const node = reader_->find(*table_, lengths.name))
      lengths.of(*settings_) = reader_->numbers<5>(*node, lengths.name);
  }
  void read(const flow::BrushesSetting& brushes) const {
    auto& of_fingers = brushes.of(*settings_);
    const toml::node* const found = reader_->find(*table_, brushes.name);
    if (found == nullptr) return;
    const toml::node& node = *found;
    const toml::array* const names = node.as_array();
    if (names == nullptr || names->size() != of_fingers.size())
      return reader_->complain(node, "brushes must be five names, thumb to little finger");
    for (std::size_t finger = 0; finger < of_fingers.size(); ++finger) {
      const auto name = (*names)[finger].value<std::string>();
      const auto brush = name ? deform::brush_named(*name) : std::nullopt;
      if (!brush) return reader_->complain((*names)[finger], "this is no brush");
      of_fingers[finger] = *brush;
    }
  }

  TomlReader* reader_;
  const toml::table* table_;
  flow::LoopSettings* settings_;
};

void read_sculptor(TomlReader& reader, const toml::table& root, bool is_puppet,
                   flow::SculptorOptions& sculptor) {
  const toml::table* const table = reader.table(root, "sculptor");
  if (table == nullptr) return;
  const std::string_view rule = rule_of_sculptor(is_puppet);
  std::vector<std::string_view> keys{"piece_length", "polynomial", "merge_fraction", "weight_bytes",
                                     "shared",       "own",        "injective",      rule};
  flow::LoopSettings settings;
  flow::for_each_plain_setting([&](const auto& setting) {
    keys.push_back(setting.name);
    SettingReader(reader, *table, settings)(setting);
  });
  reader.allow_only(*table, keys);
  flow::set_plain_settings(sculptor, settings);
  auto& options = sculptor.deformer;
  sculptor.piece_length = reader.number(*table, "piece_length");
  require_rule(reader, *table, rule);
  options.csrbf.polynomial = reader.named(*table, "polynomial", deform::polynomial_named);
  options.csrbf.merge_fraction = reader.number(*table, "merge_fraction");
  options.evaluation.weight_bytes =
      reader.count(*table, "weight_bytes", std::numeric_limits<std::int64_t>::max());
  read_supports(reader, *table, is_puppet ? "point" : "tip", options.supports);
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

void read_hand_shape(TomlReader& reader, const toml::table& table, hand::WearerShape& shape) {
  const toml::array* const terms = reader.array(table, "shape");
  if (terms == nullptr) return;
  if (terms->size() != hand::shape_terms)
    return reader.complain(table, "shape must have " + std::to_string(hand::shape_terms) +
                                      " numbers; leave it out for an average hand");
  for (std::size_t k = 0; k < terms->size(); ++k)
    shape.terms[k] = reader.number(*terms->get(k), "shape");
}

HandTrack read_hand(TomlReader& reader, const toml::table& table) {
  reader.allow_only(table, {"side", "length_m", "breadth_m", "shape", "keys"});
  HandTrack hand;
  hand.side = reader.named(table, "side", side_named);
  hand.size.length_m = reader.number(table, "length_m");
  hand.size.breadth_m = reader.number(table, "breadth_m");
  if (table.get("shape") != nullptr) read_hand_shape(reader, table, hand.size.shape);
  if (const toml::array* const keys = reader.array(table, "keys"))
    reader.each_table(*keys, "a key",
                      [&](const toml::table& key) { hand.keys.push_back(read_key(reader, key)); });
  return hand;
}

flow::LoopSettings read_settings(TomlReader& reader, const toml::table& event) {
  flow::LoopSettings settings;
  const toml::table* const table = reader.table(event, "settings");
  if (table == nullptr) return settings;
  std::vector<std::string_view> keys;
  flow::for_each_shape_setting([&](const auto& setting) {
    keys.push_back(setting.name);
    SettingReader(reader, *table, settings)(setting);
  });
  reader.allow_only(*table, keys);
  return settings;
}

/// Returns 0, with an error, if the puppet has no such function.
std::uint16_t read_function(TomlReader& reader, const toml::table& table, std::string_view key,
                            const puppet::Puppet& puppet) {
  const std::string name = reader.text(table, key);
  const auto found = puppet.function_named(name);
  if (!found) reader.complain(table, "the puppet has no function '" + name + "'");
  return static_cast<std::uint16_t>(found.value_or(0));
}

flow::SetClutch read_clutch(TomlReader& reader, const toml::table& event) {
  const toml::table* const table = reader.table(event, "clutch");
  if (table == nullptr) return {};
  reader.allow_only(*table, {"hand", "finger", "holds"});
  return {reader.named(*table, "hand", side_named), reader.named(*table, "finger", clutched_named),
          reader.truth(*table, "holds")};
}

flow::SetRole read_role(TomlReader& reader, const toml::table& event, const puppet::Rig* rig) {
  const toml::table* const table = reader.table(event, "role");
  if (table == nullptr) return {};
  reader.allow_only(*table, {"function", "input"});
  if (rig == nullptr) reader.complain(*table, "a role is of a puppet's function; add [puppet]");
  if (rig == nullptr) return {};
  return {read_function(reader, *table, "function", rig->puppet()),
          reader.named(*table, "input", puppet::HandSignal::named)};
}

/// `message` begins with ":LINE: ", which counts from the line below the key if the text is written
/// in several lines.
void complain_in_text(TomlReader& reader, const toml::node& text, const std::string& message) {
  std::size_t line = 0;
  const auto [end, error] =
      std::from_chars(message.data() + 1, message.data() + message.size(), line);
  const auto& source = text.source();
  const bool is_below = error == std::errc{} && source.end.line > source.begin.line;
  const std::string what = message.substr(static_cast<std::size_t>(end - message.data()));
  reader.complain(source.begin.line + (is_below ? line : 0), "the puppet's text" + what);
}

/// The strings of all masks, by their numbers; an empty one: none.
void read_masks(TomlReader& reader, const toml::table& root, Timeline& timeline) {
  const toml::array* const strings = reader.array(root, "masks");
  if (strings == nullptr) return;
  for (const toml::node& node : *strings) {
    const auto text = node.value<std::string>();
    if (!text) return reader.complain(node, "masks must be strings with mask files");
    auto& masks = timeline.masks.emplace_back();
    if (text->empty()) continue;
    auto puppet = puppet::parse_puppet(*text, "");
    if (!puppet) return complain_in_text(reader, node, puppet.error().message);
    if (puppet->is_played()) return reader.complain(node, "masks must have no points");
    masks = std::make_shared<const puppet::Rig>(*std::move(puppet), deform::Points(3, 0));
  }
}

/// The places of all wires, by their numbers.
void read_wires(TomlReader& reader, const toml::table& root, Timeline& timeline) {
  const toml::array* const wires = reader.array(root, "wires");
  if (wires == nullptr) return;
  for (const toml::node& node : *wires) {
    const toml::array* const places = node.as_array();
    if (places == nullptr || places->size() > flow::WirePath::max_places)
      return reader.complain(node, "a wire must be a list of at most " +
                                       std::to_string(flow::WirePath::max_places) + " places");
    auto& wire = timeline.wires.emplace_back();
    for (const toml::node& place : *places) {
      const auto ends = reader.numbers<6>(place, "a wire's place");
      wire.push_back({Eigen::Vector3d::Map(ends.data()), Eigen::Vector3d::Map(ends.data() + 3)});
    }
    if (reader.error()) return;
  }
}

flow::Command read_request(TomlReader& reader, const toml::table& event) {
  const auto name = event["request"].value<std::string_view>();
  if (name == "subdivide") return flow::Subdivide{};
  if (name == "mark") return flow::Mark{};
  if (name == "topology") return flow::ChangeTopology{};
  return reader.named(event, "request", flow::request_named);
}

flow::Command read_command(TomlReader& reader, const toml::table& event, const puppet::Rig* rig) {
  if (event.size() > 2)
    reader.complain(event, "an event has a time and one thing that happens; make two events of it");
  if (event.contains("settings")) return flow::ChangeSettings{read_settings(reader, event)};
  if (event.contains("clutch")) return read_clutch(reader, event);
  if (event.contains("role")) return read_role(reader, event, rig);
  if (event.contains("masks"))
    return flow::ChangePuppet{static_cast<std::uint32_t>(reader.count(event, "masks", max_events))};
  if (event.contains("symmetric")) return flow::SetSymmetry{reader.truth(event, "symmetric")};
  const auto number = [&](const char* name) {
    constexpr std::uint32_t most = deform::no_index - 1;
    return static_cast<std::uint32_t>(reader.count(event, name, most));
  };
  if (event.contains("cut")) return flow::ChangeModel{number("cut"), flow::ModelSource::cut};
  if (event.contains("join")) return flow::JoinParts{reader.number(event, "join")};
  if (event.contains("copy_part")) return flow::EditPart{false, number("copy_part")};
  if (event.contains("remove_part")) return flow::EditPart{true, number("remove_part")};
  if (event.contains("refine"))
    return flow::Refine{static_cast<std::uint32_t>(
        reader.count(event, "refine", std::numeric_limits<std::uint32_t>::max()))};
  return read_request(reader, event);
}

void read_events(TomlReader& reader, const toml::table& root, Timeline& timeline) {
  const toml::array* const events = reader.array(root, "events");
  if (events == nullptr) return;
  reader.each_table(*events, "an event", [&](const toml::table& event) {
    reader.allow_only(event, {"time_s", "request", "settings", "clutch", "role", "symmetric",
                              "masks", "refine", "cut", "join", "copy_part", "remove_part"});
    Event read;
    read.time_s = reader.number(event, "time_s");
    read.command = read_command(reader, event, timeline.rig.get());
    timeline.events.push_back(read);
    if (!reader.error() && flow::is_for_puppet(read.command) && timeline.rig == nullptr)
      reader.complain(event, "is about a puppet, and there is none; add [puppet]");
  });
}

/// Where the points are on the model, by their names.
deform::Points read_starts(TomlReader& reader, const toml::table& table,
                           const puppet::Puppet& puppet) {
  deform::Points starts = deform::Points::Zero(3, static_cast<Eigen::Index>(puppet.points.size()));
  const toml::table* const places = reader.table(table, "starts");
  if (places == nullptr) return starts;
  for (const auto& [key, node] : *places) {
    const std::string name(key.str());
    if (std::ranges::find(puppet.points, name, &puppet::PuppetPoint::name) == puppet.points.end())
      reader.complain(node, "the puppet has no point '" + name + "'");
  }
  for (std::size_t at = 0; at < puppet.points.size(); ++at) {
    const std::string& name = puppet.points[at].name;
    const toml::node* const place = reader.find(*places, name);
    if (place == nullptr) return starts;
    const auto numbers = reader.numbers<3>(*place, name);
    starts.col(static_cast<Eigen::Index>(at)) = Eigen::Vector3d::Map(numbers.data());
  }
  return starts;
}

void read_rig_state(TomlReader& reader, const toml::table& table, const puppet::Puppet& puppet,
                    puppet::RigState& state) {
  state.symmetric = table.contains("symmetric") && reader.truth(table, "symmetric");
  if (!table.contains("functions")) return;
  const toml::array* const functions = reader.array(table, "functions");
  if (functions == nullptr) return;
  reader.each_table(*functions, "a function", [&](const toml::table& one) {
    reader.allow_only(one, {"name", "input", "asked", "held"});
    state.functions[read_function(reader, one, "name", puppet)] = {
        reader.number(one, "asked"), reader.named(one, "input", puppet::HandSignal::named),
        reader.truth(one, "held")};
  });
}

void read_puppet(TomlReader& reader, const toml::table& root, Timeline& timeline) {
  if (!root.contains("puppet")) return;
  const toml::table* const table = reader.table(root, "puppet");
  if (table == nullptr) return;
  reader.allow_only(*table, {"text", "starts", "symmetric", "functions"});
  const std::string text = reader.text(*table, "text");
  if (reader.error()) return;
  auto puppet = puppet::parse_puppet(text, "");
  if (!puppet) return complain_in_text(reader, *table->get("text"), puppet.error().message);
  deform::Points starts = read_starts(reader, *table, *puppet);
  timeline.rig = std::make_shared<const puppet::Rig>(*std::move(puppet), std::move(starts));
  timeline.rig_state = first_state(*timeline.rig);
  read_rig_state(reader, *table, timeline.rig->puppet(), timeline.rig_state);
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
                           pull_rule, "events", "model", "sculptor", "puppet", "masks", "wires",
                           "hands"});
  Timeline timeline;
  timeline.take = reader.text(root, "take");
  timeline.units_per_metre = reader.number(root, "units_per_metre");
  timeline.rate_hz = reader.number(root, "rate_hz");
  timeline.duration_s = reader.number(root, "duration_s");
  timeline.held = reader.truth(root, "held");
  require_rule(reader, root, pull_rule);
  read_puppet(reader, root, timeline);
  if (root.contains("masks")) read_masks(reader, root, timeline);
  if (root.contains("wires")) read_wires(reader, root, timeline);
  read_events(reader, root, timeline);
  read_model(reader, root, timeline);
  read_sculptor(reader, root, timeline.rig != nullptr, timeline.sculptor);
  const toml::array* const hands = reader.array(root, "hands");
  if (hands == nullptr) return timeline;
  reader.each_table(*hands, "a hand", [&](const toml::table& hand) {
    timeline.hands.push_back(read_hand(reader, hand));
  });
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
