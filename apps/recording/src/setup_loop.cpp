#include "setup_parts.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <memory>
#include <type_traits>
#include <utility>

#include <nendo/flow/pacer.hpp>
#include <nendo/flow/setting.hpp>

namespace nendo::recording {
namespace {

constexpr std::size_t max_supports = puppet::Puppet::max_points; // of each kind
constexpr std::uint64_t max_memory = std::uint64_t{1} << 28;
constexpr std::uint32_t max_links = 1024;
constexpr std::uint32_t max_catch_up = 1000; // as parse_policy()
constexpr std::uint32_t max_points =
    puppet::Puppet::max_points; // two hands' fingertips, or a puppet's
// Rules of the loop, which unreleased programs did not have: an undo reverts a pull in type 1 as a
// step of its own; type 2 measures along the surface, and clay of few vertices is scaled.
constexpr std::uint8_t pull_rule = 1, sculptor_rules = 3, tracked_rules = 7;

void placement_fields(auto& fields, auto& placement) {
  fields.number(placement.units_per_metre, min_number, max_number);
  for (auto& pose : placement.T_stage_wrist) {
    for (Eigen::Index row = 0; row < 3; ++row)
      for (Eigen::Index column = 0; column < 4; ++column)
        fields.number(pose(row, column), -farthest_wrist_m, farthest_wrist_m);
  }
}

void table_fields(auto& fields, auto& table) {
  for (auto& coordinate : table.top)
    fields.number(coordinate, -deform::max_units, deform::max_units);
  fields.number(table.half_side, 0.0, max_number);
}

void support_fields(auto& fields, auto& support) {
  fields.number(support.radius, 0.0, max_number);
  fields.number(support.weight, 0.0, max_number);
}

void deformer_fields(auto& fields, auto& options) {
  auto& supports = options.supports;
  fields.list(supports.shared, max_supports,
              [&](auto& support) { support_fields(fields, support); });
  fields.list(supports.own, max_supports, [&](auto& own) {
    fields.whole(own.point, 0, max_points - 1);
    support_fields(fields, own.support);
  });
  fields.require(!supports.shared.empty() && supports.are_usable());
  fields.one_of(options.csrbf.kernel, deform::Wendland::c6);
  fields.one_of(options.csrbf.polynomial, deform::Polynomial::linear);
  fields.number(options.csrbf.merge_fraction, 0.0, 1.0);
  fields.reserved();
  fields.size(options.evaluation.weight_bytes, max_memory);
  fields.size(options.undo_bytes, max_memory);
  bool injects = options.injective.has_value();
  deform::InjectiveOptions injective = options.injective.value_or(deform::InjectiveOptions{});
  fields.flag(injects);
  fields.number(injective.max_bound, 0.01, 0.999);
  fields.whole(injective.max_links, 1, max_links);
  fields.number(injective.min_gap, 0.0, 1.0);
  if (injects) {
    if constexpr (std::remove_cvref_t<decltype(fields)>::reads) options.injective = injective;
  }
}

void number_field(auto& fields, const flow::NumberSetting& number, auto& settings) {
  fields.number(number.of(settings), number.range.min, number.range.max);
}

void settings_fields(auto& fields, auto& settings) {
  namespace setting = flow::setting;
  fields.one_of(setting::mode.of(settings), flow::Mode::parts);
  fields.one_of(setting::kernel.of(settings), deform::Wendland::c6);
  fields.flag(setting::injective.of(settings));
  fields.filter_kind(settings.filter);
  for (auto& radius : setting::radius.of(settings))
    fields.number(radius, setting::radius.range.min, setting::radius.range.max);
  number_field(fields, setting::piece_fraction, settings);
  flow::for_each_filter_number(
      [&](const flow::NumberSetting& number) { number_field(fields, number, settings); });
  fields.require(settings.are_usable());
}

void brush_fields(auto& fields, auto& settings) {
  constexpr auto last = static_cast<deform::Brush>(deform::brush_count - 1);
  for (auto& brush : flow::setting::brushes.of(settings))
    fields.one_of(brush, last);
  number_field(fields, flow::setting::brush_strength, settings);
}

void hold_fields(auto& fields, auto& settings) {
  number_field(fields, flow::setting::keep_volume, settings);
  fields.one_of(flow::setting::hold.of(settings), flow::Hold::hand);
}

void all_settings_fields(auto& fields, auto& settings) {
  settings_fields(fields, settings);
  brush_fields(fields, settings);
  hold_fields(fields, settings);
}

void loop_fields(auto& fields, auto& loop) {
  constexpr bool reads = std::remove_cvref_t<decltype(fields)>::reads;
  auto& options = loop.options;
  fields.text(loop.mesh);
  fields.u64(loop.mesh_sum.vertices);
  fields.u32(loop.mesh_sum.crc);
  placement_fields(fields, loop.placement);
  fields.number(options.rate_hz, flow::TickGrid::min_rate_hz, flow::TickGrid::max_rate_hz);
  fields.one_of(options.policy, flow::OverrunPolicy::sample);
  fields.whole(options.max_catch_up, 1, max_catch_up);
  fields.time_span(options.silent_after);
  fields.require(options.silent_after >= HostClock::duration::zero());
  fields.one_of(options.switch_action, flow::SwitchAction::keep);
  fields.one_of(options.sculptor.mode, flow::Mode::parts);
  fields.number(options.sculptor.piece_length, min_number, max_number);
  deformer_fields(fields, options.sculptor.deformer);
  fields.text(loop.simd);
  fields.u64(options.undo_max_bytes);
  bool held = options.begins_held();
  fields.flag(held);
  fields.optional(options.settings, [&](auto& settings) { settings_fields(fields, settings); });
  auto subdivisions = static_cast<std::uint32_t>(plain_origins(loop));
  fields.whole(subdivisions, 0, max_plain_origins);
  fields.constant(pull_rule);
  flow::LoopSettings plain = flow::plain_settings_of(options.sculptor);
  brush_fields(fields, plain);
  hold_fields(fields, plain);
  if constexpr (reads) {
    options.held = held;
    loop.origins.assign(std::min<std::size_t>(subdivisions, max_plain_origins),
                        std::make_shared<const flow::ModelOrigin>(
                            flow::ModelOrigin{.source = flow::ModelSource::subdivided}));
    flow::set_plain_settings(options.sculptor, plain);
    if (options.settings) {
      options.settings->brushes = plain.brushes;
      options.settings->brush_strength = plain.brush_strength;
    }
  }
  if (options.settings) hold_fields(fields, *options.settings);
  fields.optional(loop.placement.table, [&](auto& table) { table_fields(fields, table); });
  fields.flag_constant(sculptor_rules, tracked_rules, loop.is_tracked);
}

/// Of a block. False for NaN.
bool is_usable(float coordinate) noexcept {
  return std::abs(static_cast<double>(coordinate)) <= deform::max_units;
}

} // namespace

void put_loop(ByteWriter& writer, const LoopSetup& loop) {
  FieldWriter fields(writer);
  loop_fields(fields, loop);
}

bool read_loop(ByteReader& reader, std::optional<LoopSetup>& loop) {
  FieldReader fields(reader);
  LoopSetup read;
  loop_fields(fields, read);
  if (loop || !fields.fine()) return false;
  loop = std::move(read);
  return true;
}

void settings_body(FieldWriter& fields, const flow::LoopSettings& settings) {
  all_settings_fields(fields, settings);
}

void settings_body(FieldReader& fields, flow::LoopSettings& settings) {
  all_settings_fields(fields, settings);
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

namespace {

void starts_fields(auto& fields, auto& starts) {
  const std::size_t count =
      fields.count(static_cast<std::size_t>(starts.cols()), puppet::Puppet::max_points);
  if constexpr (std::remove_cvref_t<decltype(fields)>::reads)
    starts.resize(3, static_cast<Eigen::Index>(count));
  for (Eigen::Index at = 0; at < starts.cols(); ++at)
    for (Eigen::Index axis = 0; axis < 3; ++axis)
      fields.number(starts(axis, at), -max_number, max_number);
}

void puppet_fields(auto& fields, auto& puppet, auto& state) {
  constexpr double max_value = 1e9;
  fields.long_text(puppet.text);
  fields.list(state.functions, puppet::Puppet::max_functions, [&](auto& function) {
    fields.number(function.asked, -max_value, max_value);
    fields.signal(function.input);
    fields.flag(function.held);
  });
  fields.flag(state.symmetric);
  starts_fields(fields, puppet.starts);
  for (auto& holds : state.hand_holds)
    fields.flag(holds);
}

void puppet_version_fields(auto& fields, auto& number, auto& puppet) {
  fields.u32(number);
  fields.long_text(puppet.text);
  starts_fields(fields, puppet.starts);
}

} // namespace

void put_puppet(ByteWriter& writer, const LoopSetup& loop) {
  FieldWriter fields(writer);
  puppet_fields(fields, loop.puppet, loop.options.rig_state);
}

bool read_puppet(ByteReader& reader, std::optional<LoopSetup>& loop) {
  FieldReader fields(reader);
  RecordedPuppet read;
  puppet::RigState state;
  puppet_fields(fields, read, state);
  if (!loop || !loop->puppet.text.empty() || !fields.fine()) return false;
  loop->puppet = std::move(read);
  loop->options.rig_state = std::move(state);
  return true;
}

void put_puppet_version(ByteWriter& writer, std::uint32_t number, const RecordedPuppet& puppet) {
  FieldWriter fields(writer);
  puppet_version_fields(fields, number, puppet);
}

std::optional<NumberedPuppet> read_puppet_version(std::span<const std::byte> payload) {
  return read_value<NumberedPuppet>(payload, [](auto& fields, auto& read) {
    puppet_version_fields(fields, read.number, read.puppet);
  });
}

} // namespace nendo::recording
