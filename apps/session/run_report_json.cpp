#include "session/run_session.hpp"

#include <nlohmann/json.hpp>

#include <nendo/driver/record_counts.hpp>
#include <nendo/flow/setting.hpp>

#include "cli/cli.hpp"
#include "cli/model_files.hpp"
#include "gloves/glove_json.hpp"
#include "session/setting_options.hpp"

namespace nendo::session {
namespace {

using nlohmann::ordered_json;

ordered_json percentiles(const flow::Histogram& histogram) {
  return {{"count", histogram.count()},
          {"min", to_milliseconds(histogram.min())},
          {"p50", to_milliseconds(histogram.percentile(0.50))},
          {"p90", to_milliseconds(histogram.percentile(0.90))},
          {"p99", to_milliseconds(histogram.percentile(0.99))},
          {"max", to_milliseconds(histogram.max())}};
}

// Contains only the sensors that had spikes.
ordered_json spikes_json(const std::array<std::uint64_t, sensor_slots>& spikes) {
  ordered_json by_sensor = ordered_json::object();
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    if (spikes[slot] > 0) by_sensor[std::string(sensor_names[slot])] = spikes[slot];
  }
  return by_sensor;
}

ordered_json slips_json(const hand::SensorAngles& slips_counts, SensorMask sensors) {
  ordered_json by_sensor;
  for (std::size_t slot = 0; slot < sensor_slots; ++slot)
    if (sensors.has(static_cast<Sensor>(slot)))
      by_sensor[std::string(sensor_names[slot])] = slips_counts[slot];
  return by_sensor;
}

ordered_json ranges_json(const hand::SensorRanges& ranges, SensorMask sensors) {
  ordered_json by_sensor = ordered_json::object();
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    if (!sensors.has(static_cast<Sensor>(slot))) continue;
    by_sensor[std::string(sensor_names[slot])] = {{"low_counts", ranges[slot].low_counts},
                                                  {"high_counts", ranges[slot].high_counts},
                                                  {"turns", ranges[slot].turns}};
  }
  return by_sensor;
}

// The filter, and how late it made the hands. Its lag comes on top of end to end.
ordered_json filter_json(const hand::FilterOptions& filter, const flow::LoopStats& stats) {
  ordered_json line{{"kind", hand::name_of(filter.kind)}};
  if (filter.kind == hand::FilterKind::off) return line;
  flow::for_each_filter_number([&](const flow::NumberSetting& number) {
    line[std::string(number.name)] = number.of(filter);
  });
  line["moving_latency_ms"] = percentiles(stats.filter_moving);
  line["worst_latency_ms"] = percentiles(stats.filter_worst);
  return line;
}

ordered_json injective_json(const RunOptions& options, const flow::LoopStats& stats) {
  if (!options.loop.sculptor.deformer.injective) return nullptr;
  return {{"max_links", stats.max_links},
          {"max_bound", stats.max_bound},
          {"min_determinant", stats.min_determinant},
          {"held_apart_ticks", stats.held_apart_ticks}};
}

ordered_json clay_json(const flow::LoopStats& stats, double units_per_metre) {
  const flow::ClayState& clay = stats.clay;
  if (!clay.is_clay) return nullptr;
  const double cm3 = 1e6 / (units_per_metre * units_per_metre * units_per_metre);
  return {{"touching_ticks", stats.touching_ticks},
          {"max_penetration_mm", stats.max_penetration_mm},
          {"first_volume_cm3", cm3 * clay.first_volume},
          {"volume_cm3", cm3 * clay.volume}};
}

ordered_json wrist_json(const gloves::OpenHand& hand, const flow::WristStats& stats) {
  const driver::TrackerStation& station = hand.wrist->station;
  const driver::StreamStats sent = station.tracker->stats();
  ordered_json line{{"tracker", station.source},
                    {"model", station.tracker->info().model},
                    {"station", station.station},
                    {"poses", stats.counts.poses},
                    {"refused_poses", stats.counts.refused},
                    {"flips", stats.counts.flips},
                    {"losses", stats.counts.losses},
                    {"releases", stats.releases},
                    {"lost", stats.is_lost},
                    {"ring_refused", sent.ring_refused},
                    {"reopened", sent.reopened}};
  gloves::add_counts(line, driver::counts_of(sent));
  return line;
}

ordered_json recordings_json(const std::vector<RecordingOutcome>& recordings) {
  auto lines = ordered_json::array();
  for (const auto& [file, recorded] : recordings) {
    ordered_json line{{"file", file}, {"failed", !recorded}};
    if (recorded) {
      line["samples"] = recorded->samples;
      line["ticks"] = recorded->ticks;
      line["lost"] = recorded->lost;
      line["bytes"] = recorded->bytes;
      line["kept"] = recorded->kept;
      line["gloves"] = ordered_json::array();
      for (const auto& counts : recorded->sent)
        gloves::add_counts(line["gloves"].emplace_back(ordered_json::object()), counts);
    }
    lines.push_back(std::move(line));
  }
  return lines;
}

ordered_json published_json(const RunOutcome& outcome) {
  auto list = ordered_json::array();
  for (const auto& to : outcome.published) {
    if (const auto* segment = std::get_if<publish::SegmentCounts>(&to.counts))
      list.push_back({{"target", to.target},
                      {"records", segment->records},
                      {"bytes", segment->bytes},
                      {"shape_changes", segment->shape_changes},
                      {"locked", segment->is_locked}});
    if (const auto* sent = std::get_if<publish::OscCounts>(&to.counts))
      list.push_back({{"target", to.target},
                      {"records", sent->records},
                      {"bytes", sent->bytes},
                      {"datagrams", sent->datagrams},
                      {"skipped_records", sent->skipped},
                      {"lost_records", sent->lost},
                      {"refused_datagrams", sent->refused}});
    if (const auto* served = std::get_if<publish::VrpnCounts>(&to.counts))
      list.push_back({{"target", to.target},
                      {"records", served->records},
                      {"skipped_records", served->skipped},
                      {"lost_records", served->lost},
                      {"clients", served->clients},
                      {"refused_clients", served->refused},
                      {"missed_records", served->missed}});
  }
  return list;
}

/// Adds those that the sculptor has as they are. The radius is in the model's units.
void add_settings(ordered_json& line, const RunOutcome& outcome) {
  const flow::LoopSettings settings = flow::plain_settings_of(outcome.sculptor);
  flow::for_each_plain_setting([&](const auto& setting) {
    line[std::string(setting.name)] = flow::reported_value(setting, settings);
  });
  line["radius"] = outcome.radius;
}

} // namespace

void print_progress_json(const flow::Frame& frame, double elapsed_s) {
  ordered_json line{{"event", "progress"},      {"elapsed_s", elapsed_s},
                    {"ticks", frame.ticks_run}, {"missed", frame.missed},
                    {"held", frame.held},       {"pairs_held_apart", frame.chain.held_pairs}};
  if (frame.clay.is_clay)
    line["clay"] = {{"touching", frame.clay.touching},
                    {"penetration_mm", frame.clay.penetration_mm},
                    {"volume_part", frame.clay.volume_part()}};
  if (frame.parts.count > 0) {
    const auto name = [](std::uint32_t part) {
      return part == deform::no_index ? ordered_json() : ordered_json(part);
    };
    line["parts"] = {{"count", frame.parts.count},
                     {"held", {name(frame.parts.held[0]), name(frame.parts.held[1])}}};
  }
  for (const Side side : {Side::left, Side::right}) {
    const auto& hand = frame.hands[flow::Placement::index_of(side)];
    if (!hand.present) continue;
    ordered_json& of_hand = line[std::string(name_of(side))];
    of_hand = {{"samples", hand.samples}, {"silent", hand.silent}};
    if (hand.tracked)
      of_hand.update({{"poses", hand.pose_counts.poses},
                      {"refused_poses", hand.pose_counts.refused},
                      {"wrist_lost", hand.lost}});
  }
  cli::print_line(line);
}

void print_summary_json(const RunOptions& options, const std::vector<gloves::OpenHand>& hands,
                        const RunOutcome& outcome) {
  const auto& stats = outcome.stats;
  ordered_json line{{"event", "summary"}, {"elapsed_s", outcome.elapsed_s}};
  add_settings(line, outcome);
  line.update({{"rate_hz", options.loop.rate_hz},
               {"policy", flow::describe_policy(options.loop)},
               {"threads", options.loop.sculptor.deformer.evaluation.threads},
               {"realtime", grants_json(outcome.grants)},
               {"ticks", stats.ticks},
               {"overruns", stats.overruns},
               {"missed", stats.missed},
               {"failed", stats.failed},
               {"switch", flow::name_of(options.loop.switch_action)},
               {"grabs", stats.grabs},
               {"commits", stats.commits},
               {"undos", stats.undos},
               {"redos", stats.redos},
               {"undo_steps", stats.undo_steps},
               {"forgotten_steps", stats.forgotten_steps},
               {"refused_steps", stats.refused_steps}});
  for (const auto& hand : hands) {
    const std::size_t slot = flow::Placement::index_of(hand.side);
    const auto glove = hand.glove->stats();
    ordered_json& of_hand = line[std::string(name_of(hand.side))];
    of_hand = {{"glove", hand.glove->info().source},
               {"model", hand.glove->info().model},
               {"hand_length_mm", 1e3 * hand.wearer.of(hand.first.side).size.length_m},
               {"samples", stats.samples[slot]},
               {"samples_per_s", stats.rates[slot].per_s()},
               {"silences", stats.silences[slot]},
               {"spikes", spikes_json(stats.spikes[slot])},
               {"left_out", gloves::sensors_json(stats.left_out[slot])},
               {"was_left_out", gloves::sensors_json(stats.was_left_out[slot])},
               {"switch_uses", stats.switch_uses[slot]},
               {"ring_refused", glove.ring_refused},
               {"reopened", glove.reopened}};
    gloves::add_counts(of_hand, driver::counts_of(glove));
    if (hand.wearer.adapt)
      of_hand["ranges"] = ranges_json(stats.ranges[slot], hand.glove->info().sensors);
    if (hand.wearer.ends)
      of_hand["slips_counts"] =
          slips_json(stats.slips_counts[slot], hand.wearer.ends->counts.present);
    if (is_moved(hand, stats)) of_hand["wrist"] = wrist_json(hand, stats.wrists[slot]);
  }
  line["injective"] = injective_json(options, stats);
  line["clay"] = clay_json(stats, outcome.units_per_metre);
  line["filter"] = filter_json(options.filter, stats);
  line[std::string(flow::setting::pinches.name)] =
      flow::name_of_pinches(options.filter.close_pinches);
  line["end_to_end_ms"] = percentiles(stats.end_to_end);
  if (stats.pose_to_frame.count() > 0) {
    line["pose_to_frame_ms"] = percentiles(stats.pose_to_frame);
    line["pose_age_ms"] = percentiles(stats.pose_age);
  }
  if (outcome.pictures) {
    line["picture_ms"] = percentiles(outcome.pictures->whole);
    line["picture_preparing_ms"] = percentiles(outcome.pictures->preparing);
  }
  line["wake_latency_ms"] = percentiles(stats.wake_latency);
  line["work_ms"] = percentiles(stats.work);
  line["vertices"] = outcome.vertices;
  line["vertices_per_s"] =
      static_cast<double>(outcome.vertices) * static_cast<double>(stats.ticks) / outcome.elapsed_s;
  line["recordings"] = recordings_json(outcome.recordings);
  line["published"] = published_json(outcome);
  line["model_notes"] = cli::model_notes();
  line["result"] = outcome.result;
  cli::print_line(line);
}

} // namespace nendo::session
