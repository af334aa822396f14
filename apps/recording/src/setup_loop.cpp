#include "setup_parts.hpp"

#include <bit>
#include <cmath>
#include <utility>

#include <nendo/flow/setting.hpp>
#include <nendo/flow/tick_grid.hpp>
#include <nendo/recording/sample_record.hpp>

namespace nendo::recording {
namespace {

constexpr std::size_t max_supports = puppet::Puppet::max_points; // of each kind
constexpr std::uint64_t max_memory = std::uint64_t{1} << 28;
constexpr std::uint32_t max_links = 1024;
constexpr std::uint32_t max_catch_up = 1000;              // as parse_policy()
constexpr double max_points = puppet::Puppet::max_points; // two hands' fingertips, or a puppet's
constexpr double largest_number = 1e100;                  // as the solver takes
// Rules of the loop, which unreleased programs did not have: an undo reverts a pull in type 1 as a
// step of its own; type 2 measures along the surface, and clay of few vertices is scaled.
constexpr std::uint8_t pull_rule = 1, sculptor_rules = 3;

void read_number(CheckedReader& checked, const flow::NumberSetting& number,
                 flow::LoopSettings& settings) {
  number.of(settings) = checked.number(number.range.min, number.range.max);
}

void put_placement(ByteWriter& writer, const flow::Placement& placement) {
  writer.f64_le(placement.units_per_metre);
  for (const auto& pose : placement.T_stage_wrist) {
    for (Eigen::Index row = 0; row < 3; ++row)
      for (Eigen::Index column = 0; column < 4; ++column)
        writer.f64_le(pose(row, column));
  }
}

flow::Placement read_placement(CheckedReader& checked) {
  constexpr double min_scale = 1e-100;
  constexpr double farthest_m = 1e6;
  flow::Placement placement;
  placement.units_per_metre = checked.number(min_scale, largest_number);
  for (auto& pose : placement.T_stage_wrist) {
    for (Eigen::Index row = 0; row < 3; ++row)
      for (Eigen::Index column = 0; column < 4; ++column)
        pose(row, column) = checked.number(-farthest_m, farthest_m);
  }
  return placement;
}

void put_table(ByteWriter& writer, const flow::Placement& placement) {
  writer.u8(static_cast<std::uint8_t>(placement.table.has_value()));
  if (!placement.table) return;
  for (const double coordinate : placement.table->top)
    writer.f64_le(coordinate);
  writer.f64_le(placement.table->half_side);
}

std::optional<flow::Table> read_table(ByteReader& reader, CheckedReader& checked) {
  if (reader.u8() == 0) return std::nullopt;
  flow::Table table;
  for (double& coordinate : table.top)
    coordinate = checked.number(-deform::max_units, deform::max_units);
  table.half_side = checked.number(0.0, largest_number);
  return table;
}

void put_support(ByteWriter& writer, const deform::Support& support) {
  writer.f64_le(support.radius);
  writer.f64_le(support.weight);
}

deform::Support read_support(CheckedReader& checked) {
  const double radius = checked.number(0.0, largest_number);
  return {radius, checked.number(0.0, largest_number)};
}

void put_deformer(ByteWriter& writer, const deform::DeformerOptions& options) {
  const auto count = [](const auto& list) { return static_cast<std::uint16_t>(list.size()); };
  writer.u16_le(count(options.supports.shared));
  for (const auto& support : options.supports.shared)
    put_support(writer, support);
  writer.u16_le(count(options.supports.own));
  for (const auto& own : options.supports.own) {
    writer.u32_le(static_cast<std::uint32_t>(own.point));
    put_support(writer, own.support);
  }
  writer.u8(static_cast<std::uint8_t>(options.csrbf.kernel));
  writer.u8(static_cast<std::uint8_t>(options.csrbf.polynomial));
  writer.f64_le(options.csrbf.merge_fraction);
  writer.u16_le(0); // reserved
  writer.u64_le(options.evaluation.weight_bytes);
  writer.u64_le(options.undo_bytes);
  writer.u8(static_cast<std::uint8_t>(options.injective.has_value()));
  const auto injective = options.injective.value_or(deform::InjectiveOptions{});
  writer.f64_le(injective.max_bound);
  writer.u32_le(static_cast<std::uint32_t>(injective.max_links));
  writer.f64_le(injective.min_gap);
}

void read_supports(ByteReader& reader, CheckedReader& checked, deform::Supports& supports) {
  supports = {};
  const std::size_t shared = checked.count(max_supports);
  for (std::size_t at = 0; at < shared; ++at)
    supports.shared.push_back(read_support(checked));
  const std::size_t own = checked.count(max_supports);
  for (std::size_t at = 0; at < own; ++at) {
    const Eigen::Index point = reader.u32_le();
    checked.require(static_cast<double>(point) < max_points);
    supports.own.push_back({point, read_support(checked)});
  }
  checked.require(!supports.shared.empty() && supports.are_usable());
}

void read_deformer(ByteReader& reader, CheckedReader& checked, deform::DeformerOptions& options) {
  read_supports(reader, checked, options.supports);
  options.csrbf.kernel = checked.one_of(deform::Wendland::c6);
  options.csrbf.polynomial = checked.one_of(deform::Polynomial::linear);
  options.csrbf.merge_fraction = checked.number(0.0, 1.0);
  reader.u16_le(); // reserved
  options.evaluation.weight_bytes = checked.size(max_memory);
  options.undo_bytes = checked.size(max_memory);
  const bool injects = reader.u8() != 0;
  deform::InjectiveOptions injective;
  injective.max_bound = checked.number(0.01, 0.999);
  const std::uint32_t links = reader.u32_le();
  checked.require(links >= 1 && links <= max_links);
  injective.max_links = static_cast<int>(links);
  injective.min_gap = checked.number(0.0, 1.0);
  if (injects) options.injective = injective;
}

/// Of a block. False for NaN.
bool is_usable(float coordinate) noexcept {
  return std::abs(static_cast<double>(coordinate)) <= deform::max_units;
}

} // namespace

void put_loop(ByteWriter& writer, const LoopSetup& loop) {
  const flow::LoopOptions& options = loop.options;
  writer.text(loop.mesh);
  writer.u64_le(loop.mesh_sum.vertices);
  writer.u32_le(loop.mesh_sum.crc);
  put_placement(writer, loop.placement);
  writer.f64_le(options.rate_hz);
  writer.u8(static_cast<std::uint8_t>(options.policy));
  writer.u32_le(options.max_catch_up);
  writer.i64_le(std::chrono::nanoseconds(options.silent_after).count());
  writer.u8(static_cast<std::uint8_t>(options.switch_action));
  writer.u8(static_cast<std::uint8_t>(options.sculptor.mode));
  writer.f64_le(options.sculptor.piece_length);
  put_deformer(writer, options.sculptor.deformer);
  writer.text(loop.simd);
  writer.u64_le(options.undo_max_bytes);
  writer.u8(static_cast<std::uint8_t>(options.begins_held()));
  writer.u8(static_cast<std::uint8_t>(options.settings.has_value()));
  if (options.settings) put_settings(writer, *options.settings);
  writer.u32_le(static_cast<std::uint32_t>(plain_origins(loop)));
  writer.u8(pull_rule);
  const flow::LoopSettings settings = flow::plain_settings_of(options.sculptor);
  put_brushes(writer, settings);
  put_hold(writer, settings);
  if (options.settings) put_hold(writer, *options.settings);
  put_table(writer, loop.placement);
  writer.u8(sculptor_rules);
}

void put_brushes(ByteWriter& writer, const flow::LoopSettings& settings) {
  for (const deform::Brush brush : settings.brushes)
    writer.u8(static_cast<std::uint8_t>(brush));
  writer.f64_le(settings.brush_strength);
}

bool read_brushes(ByteReader& reader, flow::LoopSettings& settings) {
  CheckedReader checked(reader);
  for (deform::Brush& brush : settings.brushes)
    brush = checked.one_of(static_cast<deform::Brush>(deform::brush_count - 1));
  read_number(checked, flow::setting::brush_strength, settings);
  return checked.fine();
}

void put_hold(ByteWriter& writer, const flow::LoopSettings& settings) {
  writer.f64_le(flow::setting::keep_volume.of(settings));
  writer.u8(static_cast<std::uint8_t>(settings.hold));
}

bool read_hold(ByteReader& reader, flow::LoopSettings& settings) {
  CheckedReader checked(reader);
  read_number(checked, flow::setting::keep_volume, settings);
  settings.hold = checked.one_of(flow::Hold::hand);
  return checked.fine();
}

void put_settings(ByteWriter& writer, const flow::LoopSettings& settings) {
  writer.u8(static_cast<std::uint8_t>(settings.mode));
  writer.u8(static_cast<std::uint8_t>(settings.kernel));
  writer.u8(static_cast<std::uint8_t>(settings.injective));
  put_filter_kind(writer, settings.filter);
  for (const double radius : settings.radius_m)
    writer.f64_le(radius);
  writer.f64_le(settings.piece_fraction);
  put_filter_numbers(writer, settings.filter);
}

std::optional<flow::LoopSettings> read_settings(ByteReader& reader) {
  CheckedReader checked(reader);
  flow::LoopSettings settings;
  settings.mode = checked.one_of(flow::Mode::parts);
  settings.kernel = checked.one_of(deform::Wendland::c6);
  settings.injective = reader.u8() != 0;
  checked.filter_kind(settings.filter);
  for (double& radius : settings.radius_m)
    radius = reader.f64_le();
  settings.piece_fraction = reader.f64_le();
  flow::for_each_filter_number(
      [&](const flow::NumberSetting& number) { number.of(settings) = reader.f64_le(); });
  if (!checked.fine() || !settings.are_usable()) return std::nullopt;
  return settings;
}

void put_rest(ByteWriter& writer, std::span<const deform::VertexBlock> blocks) {
  for (const deform::VertexBlock& block : blocks)
    for (const auto* axis : {&block.x, &block.y, &block.z})
      for (const float coordinate : *axis)
        writer.u32_le(std::bit_cast<std::uint32_t>(coordinate));
}

bool read_rest(std::span<const std::byte> payload, std::optional<LoopSetup>& loop) {
  constexpr std::size_t block_bytes = 3 * deform::block_size * sizeof(float);
  if (!loop || payload.empty() || payload.size() % block_bytes != 0) return false;
  std::vector<deform::VertexBlock> blocks(payload.size() / block_bytes);
  ByteReader reader(payload);
  bool usable = true;
  for (deform::VertexBlock& block : blocks) {
    for (auto* axis : {&block.x, &block.y, &block.z}) {
      for (float& coordinate : *axis) {
        coordinate = std::bit_cast<float>(reader.u32_le());
        usable = usable && is_usable(coordinate);
      }
    }
  }
  if (usable) loop->rest.insert(loop->rest.end(), blocks.begin(), blocks.end());
  return usable;
}

void put_signal(ByteWriter& writer, const puppet::HandSignal& signal) {
  writer.u8(static_cast<std::uint8_t>(signal.side()));
  writer.u8(signal.number());
}

std::optional<puppet::HandSignal> read_signal(ByteReader& reader) {
  const std::uint8_t side = reader.u8();
  const std::uint8_t number = reader.u8();
  if (side > static_cast<std::uint8_t>(Side::right)) return std::nullopt;
  return puppet::HandSignal::numbered(static_cast<Side>(side), number);
}

namespace {

void put_puppet_text(ByteWriter& writer, const RecordedPuppet& puppet) {
  writer.u32_le(static_cast<std::uint32_t>(puppet.text.size()));
  writer.bytes(std::as_bytes(std::span(puppet.text)));
}

void put_puppet_starts(ByteWriter& writer, const RecordedPuppet& puppet) {
  writer.u16_le(static_cast<std::uint16_t>(puppet.starts.cols()));
  for (const double coordinate : puppet.starts.reshaped())
    writer.f64_le(coordinate);
}

/// Returns false if there is no such text.
bool read_puppet_text(ByteReader& reader, RecordedPuppet& puppet) {
  constexpr std::uint32_t max_text = std::uint32_t{1} << 20;
  const std::uint32_t size = reader.u32_le();
  if (size == 0 || size > max_text || size > reader.remaining()) return false;
  const auto text = reader.take(size);
  puppet.text.assign(reinterpret_cast<const char*>(text.data()), text.size());
  return true;
}

void read_puppet_starts(CheckedReader& checked, RecordedPuppet& puppet) {
  puppet.starts.resize(3, static_cast<Eigen::Index>(checked.count(puppet::Puppet::max_points)));
  for (double& coordinate : puppet.starts.reshaped())
    coordinate = checked.number(-largest_number, largest_number);
}

} // namespace

void put_puppet(ByteWriter& writer, const LoopSetup& loop) {
  put_puppet_text(writer, loop.puppet);
  const puppet::RigState& state = loop.options.rig_state;
  writer.u16_le(static_cast<std::uint16_t>(state.functions.size()));
  for (const puppet::FunctionState& function : state.functions) {
    writer.f64_le(function.asked);
    put_signal(writer, function.input);
    writer.u8(static_cast<std::uint8_t>(function.held));
  }
  writer.u8(static_cast<std::uint8_t>(state.symmetric));
  put_puppet_starts(writer, loop.puppet);
  for (const bool holds : state.hand_holds)
    writer.u8(static_cast<std::uint8_t>(holds));
}

void put_puppet_version(ByteWriter& writer, std::uint32_t number, const RecordedPuppet& puppet) {
  writer.u32_le(number);
  put_puppet_text(writer, puppet);
  put_puppet_starts(writer, puppet);
}

std::optional<NumberedPuppet> read_puppet_version(std::span<const std::byte> payload) {
  ByteReader reader(payload);
  CheckedReader checked(reader);
  NumberedPuppet read;
  read.number = reader.u32_le();
  if (!read_puppet_text(reader, read.puppet)) return std::nullopt;
  read_puppet_starts(checked, read.puppet);
  if (!checked.fine()) return std::nullopt;
  return read;
}

namespace {

puppet::RigState read_rig_state(ByteReader& reader, CheckedReader& checked) {
  constexpr double max_value = 1e9;
  puppet::RigState state;
  state.functions.resize(checked.count(puppet::Puppet::max_functions));
  for (puppet::FunctionState& function : state.functions) {
    function.asked = checked.number(-max_value, max_value);
    const auto input = read_signal(reader);
    checked.require(input.has_value());
    function.input = input.value_or(puppet::HandSignal{});
    function.held = reader.u8() != 0;
  }
  state.symmetric = reader.u8() != 0;
  return state;
}

} // namespace

bool read_puppet(ByteReader& reader, std::optional<LoopSetup>& loop) {
  CheckedReader checked(reader);
  RecordedPuppet read;
  if (!loop || !loop->puppet.text.empty() || !read_puppet_text(reader, read)) return false;
  puppet::RigState state = read_rig_state(reader, checked);
  read_puppet_starts(checked, read);
  for (bool& holds : state.hand_holds)
    holds = reader.u8() != 0;
  if (!checked.fine()) return false;
  loop->puppet = std::move(read);
  loop->options.rig_state = std::move(state);
  return true;
}

bool read_loop(ByteReader& reader, std::optional<LoopSetup>& loop) {
  constexpr double min_piece = 1e-100;
  CheckedReader checked(reader);
  LoopSetup read;
  flow::LoopOptions& options = read.options;
  read.mesh = reader.text();
  read.mesh_sum.vertices = reader.u64_le();
  read.mesh_sum.crc = reader.u32_le();
  read.placement = read_placement(checked);
  options.rate_hz = checked.number(flow::TickGrid::min_rate_hz, flow::TickGrid::max_rate_hz);
  options.policy = checked.one_of(flow::OverrunPolicy::sample);
  options.max_catch_up = reader.u32_le();
  checked.require(options.max_catch_up >= 1 && options.max_catch_up <= max_catch_up);
  const std::chrono::nanoseconds silent_after(reader.i64_le());
  checked.require(silent_after.count() >= 0 && is_usable_time(silent_after));
  options.silent_after = silent_after;
  options.switch_action = checked.one_of(flow::SwitchAction::keep);
  options.sculptor.mode = checked.one_of(flow::Mode::parts);
  options.sculptor.piece_length = checked.number(min_piece, largest_number);
  read_deformer(reader, checked, options.sculptor.deformer);
  read.simd = reader.text();
  options.undo_max_bytes = reader.u64_le();
  options.held = reader.u8() != 0;
  if (reader.u8() != 0) {
    options.settings = read_settings(reader);
    checked.require(options.settings.has_value());
  }
  const std::uint32_t subdivisions = reader.u32_le();
  checked.require(subdivisions <= max_plain_origins);
  if (checked.fine())
    read.origins.assign(subdivisions, std::make_shared<const flow::ModelOrigin>(flow::ModelOrigin{
                                          .source = flow::ModelSource::subdivided}));
  checked.require(reader.u8() == pull_rule);
  flow::LoopSettings settings = flow::plain_settings_of(options.sculptor);
  checked.require(read_brushes(reader, settings) && read_hold(reader, settings));
  if (options.settings) {
    options.settings->brushes = settings.brushes;
    options.settings->brush_strength = settings.brush_strength;
    checked.require(read_hold(reader, *options.settings));
  }
  flow::set_plain_settings(options.sculptor, settings);
  read.placement.table = read_table(reader, checked);
  checked.require(reader.u8() == sculptor_rules);
  if (loop || !checked.fine()) return false;
  loop = std::move(read);
  return true;
}

} // namespace nendo::recording
