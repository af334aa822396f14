#include "run_report.hpp"

#include <algorithm>
#include <cstdio>
#include <iostream>
#include <numeric>

#include <nlohmann/json.hpp>
#include <unistd.h>

#include "cli.hpp"
#include "loop_options.hpp"
#include "range_report.hpp"

namespace nendo::app {
namespace {

using nlohmann::ordered_json;

constexpr std::array<Side, 2> sides{Side::left, Side::right};

double milliseconds_of(std::chrono::nanoseconds t) {
  return static_cast<double>(t.count()) / 1e6;
}

std::string thousands(double value) {
  std::string digits = std::to_string(static_cast<long long>(value));
  for (auto at = static_cast<std::ptrdiff_t>(digits.size()) - 3; at > 0; at -= 3) {
    digits.insert(static_cast<std::size_t>(at), ",");
  }
  return digits;
}

ordered_json percentiles(const flow::Histogram& histogram) {
  ordered_json line;
  line["count"] = histogram.count();
  line["min"] = milliseconds_of(histogram.min());
  line["p50"] = milliseconds_of(histogram.percentile(0.50));
  line["p90"] = milliseconds_of(histogram.percentile(0.90));
  line["p99"] = milliseconds_of(histogram.percentile(0.99));
  line["max"] = milliseconds_of(histogram.max());
  return line;
}

void print_percentiles(const char* name, const flow::Histogram& histogram) {
  std::printf("  %-14s p50 %.3f ms, p90 %.3f ms, p99 %.3f ms, max %.3f ms\n", name,
              milliseconds_of(histogram.percentile(0.50)),
              milliseconds_of(histogram.percentile(0.90)),
              milliseconds_of(histogram.percentile(0.99)), milliseconds_of(histogram.max()));
}

void print_progress_json(const flow::Frame& frame, double elapsed_s) {
  ordered_json line{{"event", "progress"},  {"elapsed_s", elapsed_s},
                    {"ticks", frame.ticks}, {"missed", frame.missed},
                    {"held", frame.held},   {"pairs_held_apart", frame.chain.held_pairs}};
  for (std::size_t slot = 0; slot < sides.size(); ++slot) {
    if (!frame.hands[slot].present) continue;
    line[std::string(name_of(sides[slot]))] = {{"samples", frame.hands[slot].samples},
                                               {"silent", frame.hands[slot].silent}};
  }
  std::cout << line.dump() << std::endl;
}

std::string progress_line(const flow::Frame& frame, double elapsed_s, double duration_s) {
  char text[160];
  std::string line;
  if (duration_s > 0.0) {
    std::snprintf(text, sizeof text, "%5.1f of %.1f s", elapsed_s, duration_s);
  } else {
    std::snprintf(text, sizeof text, "%5.1f s (Ctrl-C ends)", elapsed_s);
  }
  line = text;
  std::snprintf(text, sizeof text, "  %llu ticks, %llu missed",
                static_cast<unsigned long long>(frame.ticks),
                static_cast<unsigned long long>(frame.missed));
  line += text;
  for (std::size_t slot = 0; slot < sides.size(); ++slot) {
    const auto& hand = frame.hands[slot];
    if (!hand.present) continue;
    line += "  " + std::string(name_of(sides[slot])) + ": ";
    line += hand.silent ? "silent" : std::to_string(hand.samples) + " samples";
  }
  if (!frame.held) line += "  let go";
  if (frame.chain.held_pairs > 0) line += "  fingertips held apart";
  return line;
}

using Spikes = std::array<std::uint64_t, sensor_slots>;

// Only the sensors that had any.
ordered_json spikes_json(const Spikes& spikes) {
  ordered_json by_sensor = ordered_json::object();
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    if (spikes[slot] > 0) by_sensor[std::string(sensor_names[slot])] = spikes[slot];
  }
  return by_sensor;
}

// What the velocity gate kept out, and where most of it came from.
void print_spikes(const Spikes& spikes) {
  const auto worst = std::max_element(spikes.begin(), spikes.end());
  if (*worst == 0) return;
  const auto all = std::accumulate(spikes.begin(), spikes.end(), std::uint64_t{0});
  std::printf("  %-14s %s spikes kept out, most of them %s's (%s): see to its cable or sensor\n",
              "", thousands(static_cast<double>(all)).c_str(),
              std::string(sensor_names[static_cast<std::size_t>(worst - spikes.begin())]).c_str(),
              thousands(static_cast<double>(*worst)).c_str());
}

void print_holds(const RunOptions& options, const flow::LoopStats& stats) {
  if (options.loop.switch_action != flow::SwitchAction::none) {
    std::printf("  %-14s %s; turned on %llu times\n", "wrist switch",
                std::string(flow::name_of(options.loop.switch_action)).c_str(),
                static_cast<unsigned long long>(stats.switch_uses[0] + stats.switch_uses[1]));
  }
  if (stats.commits + stats.grabs + stats.undos == 0) return;
  std::printf(
      "  %-14s %llu commits, %llu grabs, %llu undone, %llu redone\n", "shapes kept",
      static_cast<unsigned long long>(stats.commits), static_cast<unsigned long long>(stats.grabs),
      static_cast<unsigned long long>(stats.undos), static_cast<unsigned long long>(stats.redos));
  if (stats.forgotten_steps > 0)
    std::printf("  %-14s reached %llu steps back; the %llu before went for want of memory, "
                "--undo-memory makes more room\n",
                "undo", static_cast<unsigned long long>(stats.undo_steps),
                static_cast<unsigned long long>(stats.forgotten_steps));
}

// What the filter was and how late it made the hands; its lag comes on top of end to end.
ordered_json filter_json(const hand::FilterOptions& filter, const flow::LoopStats& stats) {
  ordered_json line{{"kind", hand::name_of(filter.kind)}};
  if (filter.kind == hand::FilterKind::off) return line;
  line["min_cutoff_hz"] = filter.min_cutoff_hz;
  line["beta_hz_per_rad_s"] = filter.beta_hz_per_rad_s;
  line["derivative_cutoff_hz"] = filter.derivative_cutoff_hz;
  line["moving_latency_ms"] = percentiles(stats.filter_moving);
  line["worst_latency_ms"] = percentiles(stats.filter_worst);
  return line;
}

void print_filter(const hand::FilterOptions& filter, const flow::LoopStats& stats) {
  if (filter.kind == hand::FilterKind::off) return;
  print_percentiles("filter's lag", stats.filter_moving);
  std::printf("  %-14s %s, min cutoff %g Hz, beta %g: of the joints that move; %.1f ms at rest; "
              "comes on top of all these\n",
              "", std::string(hand::name_of(filter.kind)).c_str(), filter.min_cutoff_hz,
              filter.beta_hz_per_rad_s, milliseconds_of(stats.filter_worst.max()));
}

ordered_json injective_json(const RunOptions& options, const flow::LoopStats& stats) {
  if (!options.loop.sculptor.deformer.injective) return nullptr;
  return {{"most_links", stats.most_links},
          {"most_bound", stats.most_bound},
          {"least_determinant", stats.least_determinant},
          {"held_apart_ticks", stats.held_apart_ticks}};
}

void print_injective(const RunOptions& options, const flow::LoopStats& stats) {
  if (!options.loop.sculptor.deformer.injective) return;
  std::printf("  %-14s at most %d links a tick, bound in one step %.3g, least determinant %.3g; "
              "fingertips held apart in %llu ticks\n",
              "injective", stats.most_links, stats.most_bound, stats.least_determinant,
              static_cast<unsigned long long>(stats.held_apart_ticks));
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
    }
    lines.push_back(std::move(line));
  }
  return lines;
}

void print_recordings(const std::vector<RecordingOutcome>& recordings) {
  for (const auto& [file, recorded] : recordings) {
    const std::string name = file.empty() ? "" : file + ", ";
    if (!recorded) {
      std::printf("  %-14s %snot complete, as was told\n", "recording", name.c_str());
      continue;
    }
    std::printf("  %-14s %s%s bytes, %llu entries lost, %llu kept\n", "recording", name.c_str(),
                thousands(static_cast<double>(recorded->bytes)).c_str(),
                static_cast<unsigned long long>(recorded->lost),
                static_cast<unsigned long long>(recorded->kept));
  }
}

ordered_json published_json(const RunOutcome& outcome) {
  auto list = ordered_json::array();
  for (const auto& to : outcome.published) {
    ordered_json line{{"target", to.target}, {"records", to.records}, {"bytes", to.bytes}};
    if (to.is_segment) {
      line["shape_changes"] = to.shape_changes;
      line["locked"] = to.is_locked;
    } else {
      line["datagrams"] = to.datagrams;
      line["lost_records"] = to.lost_records;
      line["refused_datagrams"] = to.refused_datagrams;
    }
    list.push_back(std::move(line));
  }
  return list;
}

void print_published(const RunOutcome& outcome) {
  for (const auto& to : outcome.published) {
    std::printf("  %-14s %s, %llu ticks, ", "published", to.target.c_str(),
                static_cast<unsigned long long>(to.records));
    if (to.is_segment) {
      std::printf("%s bytes%s\n", thousands(static_cast<double>(to.bytes)).c_str(),
                  to.is_locked ? "" : ", not locked in memory (see --mlockall)");
    } else {
      std::printf("%llu datagrams, %llu refused, %llu ticks lost\n",
                  static_cast<unsigned long long>(to.datagrams),
                  static_cast<unsigned long long>(to.refused_datagrams),
                  static_cast<unsigned long long>(to.lost_records));
    }
  }
}

void print_summary_json(const RunOptions& options, const std::vector<OpenHand>& hands,
                        const RunOutcome& outcome) {
  const auto& stats = outcome.stats;
  ordered_json line{{"event", "summary"},
                    {"elapsed_s", outcome.elapsed_s},
                    {"mode", flow::name_of(options.loop.sculptor.mode)},
                    {"kernel", deform::name_of(options.loop.sculptor.deformer.csrbf.kernel)},
                    {"radius", outcome.radius},
                    {"rate_hz", options.loop.rate_hz},
                    {"policy", flow::describe_policy(options.loop)},
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
                    {"forgotten_steps", stats.forgotten_steps}};
  for (const auto& hand : hands) {
    const std::size_t slot = flow::Placement::index_of(hand.side);
    const auto glove = hand.glove->stats();
    ordered_json& of_hand = line[std::string(name_of(hand.side))];
    of_hand = {{"glove", hand.glove->info().source},
               {"model", hand.glove->info().model},
               {"hand_length_mm", 1e3 * options.length.size(hand.known.own.size).length_m},
               {"samples", stats.samples[slot]},
               {"samples_per_s", static_cast<double>(stats.samples[slot]) / outcome.elapsed_s},
               {"silences", stats.silences[slot]},
               {"spikes", spikes_json(stats.spikes[slot])},
               {"switch_uses", stats.switch_uses[slot]},
               {"bad_records", glove.bad_records},
               {"ring_refused", glove.ring_refused},
               {"reopened", glove.reopened}};
    if (hand.known.adapt)
      of_hand["ranges"] = ranges_json(stats.ranges[slot], hand.glove->info().sensors);
  }
  line["injective"] = injective_json(options, stats);
  line["filter"] = filter_json(options.filter, stats);
  line["end_to_end_ms"] = percentiles(stats.end_to_end);
  line["wake_latency_ms"] = percentiles(stats.wake_latency);
  line["work_ms"] = percentiles(stats.work);
  line["vertices"] = outcome.vertices;
  line["vertices_per_s"] =
      static_cast<double>(outcome.vertices) * static_cast<double>(stats.ticks) / outcome.elapsed_s;
  line["recordings"] = recordings_json(outcome.recordings);
  line["published"] = published_json(outcome);
  line["result"] = outcome.result;
  std::cout << line.dump() << std::endl;
}

void print_summary_text(const RunOptions& options, const std::vector<OpenHand>& hands,
                        const RunOutcome& outcome) {
  const auto& stats = outcome.stats;
  std::printf("\nnendo run: %.1f s, %s, %s, radius %.3g\n", outcome.elapsed_s,
              std::string(flow::name_of(options.loop.sculptor.mode)).c_str(),
              std::string(deform::name_of(options.loop.sculptor.deformer.csrbf.kernel)).c_str(),
              outcome.radius);
  for (const auto& hand : hands) {
    const std::size_t slot = flow::Placement::index_of(hand.side);
    const auto glove = hand.glove->stats();
    std::printf("  %-14s %s samples (%.1f/s), %llu bad records, %llu lost, %llu silences; %s\n",
                (std::string(name_of(hand.side)) + " hand").c_str(),
                thousands(static_cast<double>(stats.samples[slot])).c_str(),
                static_cast<double>(stats.samples[slot]) / outcome.elapsed_s,
                static_cast<unsigned long long>(glove.bad_records),
                static_cast<unsigned long long>(glove.ring_refused),
                static_cast<unsigned long long>(stats.silences[slot]),
                hand.glove->info().source.c_str());
    print_spikes(stats.spikes[slot]);
    if (hand.known.adapt) print_ranges(stats.ranges[slot], hand.glove->info().sensors);
  }
  print_holds(options, stats);
  std::printf("  %-14s %s at %g Hz, %llu overruns, %llu missed\n", "ticks",
              thousands(static_cast<double>(stats.ticks)).c_str(), options.loop.rate_hz,
              static_cast<unsigned long long>(stats.overruns),
              static_cast<unsigned long long>(stats.missed));
  print_percentiles("wake-up", stats.wake_latency);
  print_percentiles("work a tick", stats.work);
  print_percentiles("end to end", stats.end_to_end);
  std::printf("  %-14s from a sample's last byte to the finished mesh\n", "");
  print_filter(options.filter, stats);
  print_injective(options, stats);
  std::printf("  %-14s %s a second (%s in the model)\n", "vertices",
              thousands(static_cast<double>(outcome.vertices) * static_cast<double>(stats.ticks) /
                        outcome.elapsed_s)
                  .c_str(),
              thousands(static_cast<double>(outcome.vertices)).c_str());
  print_recordings(outcome.recordings);
  print_published(outcome);
  std::printf("  %-14s %s\n", "result", outcome.result.c_str());
  std::fflush(stdout);
}

} // namespace

Progress progress_for(const RunOptions& options) {
  if (options.json) {
    return [next_s = 1.0](const flow::Frame& frame, double elapsed_s) mutable {
      if (elapsed_s < next_s) return;
      print_progress_json(frame, elapsed_s);
      next_s += 1.0;
    };
  }
  const bool terminal = isatty(STDERR_FILENO) != 0;
  return [terminal, next_s = 2.0, duration_s = options.duration_s](const flow::Frame& frame,
                                                                   double elapsed_s) mutable {
    if (!terminal && elapsed_s < next_s) return;
    next_s += 2.0;
    const std::string line = progress_line(frame, elapsed_s, duration_s);
    std::cerr << (terminal ? "\r" + line + "\x1b[K" : line + "\n") << std::flush;
  };
}

void print_summary(const RunOptions& options, const std::vector<OpenHand>& hands,
                   const RunOutcome& outcome) {
  if (options.json) {
    print_summary_json(options, hands, outcome);
  } else {
    print_summary_text(options, hands, outcome);
  }
}

} // namespace nendo::app
