#include "session/run_session.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <numeric>
#include <string_view>
#include <utility>

#include <spdlog/fmt/fmt.h>
#include <unistd.h>

#include <nendo/base/text.hpp>
#include <nendo/driver/record_counts.hpp>
#include <nendo/flow/setting.hpp>
#include <nendo/sculpting/find_wearer.hpp>

#include "cli/figures.hpp"
#include "cli/print.hpp"
#include "cli/terminal.hpp"
#include "gloves/tracker_text.hpp"

namespace nendo::session {
namespace {

/// Whether each hand is uncalibrated, by flow::Placement::index_of(side).
using Uncalibrated = std::array<bool, 2>;

std::string progress_line(const flow::Frame& frame, double elapsed_s, double duration_s,
                          const Uncalibrated& uncalibrated) {
  std::string line = duration_s > 0.0 ? fmt::format("{:5.1f} of {:.1f} s", elapsed_s, duration_s)
                                      : fmt::format("{:5.1f} s (Ctrl-C ends)", elapsed_s);
  line += fmt::format("  {} ticks, {} missed", frame.ticks_run, frame.missed);
  for (const Side side : {Side::left, Side::right}) {
    const auto& hand = frame.hands[flow::Placement::index_of(side)];
    if (!hand.present) continue;
    line += fmt::format("  {}: {}", name_of(side),
                        hand.silent ? "silent" : std::to_string(hand.samples) + " samples");
    if (hand.tracked)
      line += hand.lost ? ", wrist lost" : fmt::format(", {} poses", hand.pose_counts.poses);
    if (uncalibrated[flow::Placement::index_of(side)]) line += ", uncalibrated";
  }
  const bool has_model = frame.shape.block_count() > 0;
  if (!frame.held && has_model) line += "  released";
  if (frame.chain.held_pairs > 0) line += "  fingertips held apart";
  for (const std::uint32_t held : frame.parts.held)
    if (held != deform::no_index)
      line += fmt::format("  holds part {} of {}", held + 1, frame.parts.count);
  if (frame.clay.touching > 0) line += fmt::format("  touching at {} places", frame.clay.touching);
  return line;
}

/// The same for a narrow terminal: the most important figures first.
std::string brief_progress_line(const flow::Frame& frame, double elapsed_s,
                                const Uncalibrated& uncalibrated) {
  std::string line = fmt::format("{:5.1f} s  {} ticks", elapsed_s, frame.ticks_run);
  if (frame.missed > 0) line += fmt::format(", {} missed", frame.missed);
  std::string without;
  for (const Side side : {Side::left, Side::right}) {
    const std::size_t slot = flow::Placement::index_of(side);
    const auto& hand = frame.hands[slot];
    if (!hand.present) continue;
    line += fmt::format("  {} {}", name_of(side),
                        hand.silent ? "silent" : std::to_string(hand.samples));
    if (hand.tracked && hand.lost) line += ", lost";
    if (uncalibrated[slot]) without += (without.empty() ? "  " : ", ") + std::string(name_of(side));
  }
  if (!frame.held && frame.shape.block_count() > 0) line += "  released";
  if (frame.chain.held_pairs > 0) line += "  held apart";
  if (!without.empty()) line += without + " uncalibrated";
  return line;
}

/// Returns the beginning of a line that fits in one row of the terminal. The last column stays
/// free, because some terminals would begin the next row there.
std::string fitting(const std::string& line) {
  const auto columns = static_cast<std::size_t>(cli::screen_size(STDERR_FILENO).columns);
  return line.substr(0, columns - 1);
}

void print_row(std::string_view heading, const std::string& text) {
  cli::print("  {:14} {}\n", heading, text);
}

void print_percentiles(std::string_view name, const flow::Histogram& histogram) {
  const auto ms = [&](double fraction) { return to_milliseconds(histogram.percentile(fraction)); };
  print_row(name, fmt::format("p50 {:.3f} ms, p90 {:.3f} ms, p99 {:.3f} ms, max {:.3f} ms",
                              ms(0.50), ms(0.90), ms(0.99), to_milliseconds(histogram.max())));
}

/// Prints the sensors that were left out at the end, or for a while.
void print_left_out(SensorMask left_out, SensorMask for_a_while) {
  if (left_out.bits != 0)
    print_row("", sculpting::sensors_in_words(left_out) +
                      (sculpting::is_one(left_out) ? " is" : " are") +
                      " stuck: left out, and estimated from neighbouring sensors");
  if (for_a_while.bits != 0)
    print_row("", sculpting::sensors_in_words(for_a_while) +
                      " stuck for a while: left out and estimated during that time");
}

// Prints the spikes that the velocity gate removed, and the sensor that had most of them.
void print_spikes(const std::array<std::uint64_t, sensor_slots>& spikes) {
  const auto worst = std::max_element(spikes.begin(), spikes.end());
  if (*worst == 0) return;
  const auto all = std::accumulate(spikes.begin(), spikes.end(), std::uint64_t{0});
  print_row("", fmt::format("{} spikes removed, most of them of {} ({}): check its cable or sensor",
                            cli::thousands(all),
                            sensor_names[static_cast<std::size_t>(worst - spikes.begin())],
                            cli::thousands(*worst)));
}

void print_ranges(const hand::SensorRanges& ranges, SensorMask sensors) {
  print_row("", "learned ranges, in counts, and the number of turns of the joint:");
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    if (!sensors.has(static_cast<Sensor>(slot))) continue;
    const hand::SensorRange& range = ranges[slot];
    print_row("", fmt::format("{:22} {:5.0f} to {:5.0f}  {}", sensor_names[slot], range.low_counts,
                              range.high_counts,
                              range.turns > 0 ? std::to_string(range.turns) : "none: default"));
  }
}

void print_slips(const hand::SensorAngles& slips_counts, const hand::SensorRanges& ranges,
                 CountScale counts) {
  bool any = false;
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    if (!(std::abs(slips_counts[slot]) >= hand::min_slip_counts(counts))) continue;
    if (!std::exchange(any, true))
      print_row("", "learned slips, in counts, and the number of turns of the joint:");
    print_row("", fmt::format("{:22} {:+5.1f}  {}", sensor_names[slot], slips_counts[slot],
                              ranges[slot].turns));
  }
  if (!any) print_row("", "no sensor has slipped since the calibration");
}

/// Prints the counts of a wrist that its tracker moved.
void print_wrist(const gloves::OpenHand& hand, const flow::WristStats& stats) {
  const driver::TrackerStation& station = hand.wrist->station;
  const hand::TrackingCounts& counts = stats.counts;
  print_row(fmt::format("{} wrist", name_of(hand.side)),
            fmt::format("{} poses, {} refused, {} flips, {} losses, {} releases; {}",
                        cli::thousands(counts.poses), counts.refused, counts.flips, counts.losses,
                        stats.releases, printable(station.source)));
  print_row("", driver::in_words(driver::counts_of(station.tracker->stats())));
  if (counts.flips > 0) print_row("", gloves::hemisphere_advice);
  if (stats.is_lost) print_row("", "lost at the end: no good pose came");
}

void print_hand(const gloves::OpenHand& hand, const RunOutcome& outcome) {
  const auto& stats = outcome.stats;
  const std::size_t slot = flow::Placement::index_of(hand.side);
  const driver::GloveInfo& info = hand.glove->info();
  print_row(fmt::format("{} hand", name_of(hand.side)),
            fmt::format("{} samples ({:.1f}/s), {} silences; {}",
                        cli::thousands(stats.samples[slot]), stats.rates[slot].per_s(),
                        stats.silences[slot], info.source));
  print_row("", driver::in_words(driver::counts_of(hand.glove->stats())));
  print_spikes(stats.spikes[slot]);
  print_left_out(stats.left_out[slot],
                 {stats.was_left_out[slot].bits & ~stats.left_out[slot].bits});
  if (hand.uncalibrated)
    print_row("", "uncalibrated: its angles are those of an average hand; see `nendo calibrate`");
  if (hand.wearer.ends) {
    print_slips(stats.slips_counts[slot], stats.ranges[slot], info.counts);
  } else if (hand.wearer.adapt) {
    print_ranges(stats.ranges[slot], info.sensors);
  }
  if (is_moved(hand, stats)) print_wrist(hand, stats.wrists[slot]);
}

void print_pose_latencies(const flow::LoopStats& stats) {
  if (stats.pose_to_frame.count() == 0) return;
  print_percentiles("pose to frame", stats.pose_to_frame);
  print_row("", "from the last byte of a wrist's pose to the finished mesh");
  print_percentiles("age of poses", stats.pose_age);
  print_row("", "from their measurement, as far as the tracker's driver knows it");
}

void print_holds(const RunOptions& options, const flow::LoopStats& stats) {
  if (options.loop.switch_action != flow::SwitchAction::none)
    print_row("wrist switch",
              fmt::format("{}; turned on {} times", flow::name_of(options.loop.switch_action),
                          stats.switch_uses[0] + stats.switch_uses[1]));
  if (stats.commits + stats.grabs + stats.undos + stats.refused_steps == 0) return;
  print_row("shapes kept", fmt::format("{} commits, {} grabs, {} undone, {} redone", stats.commits,
                                       stats.grabs, stats.undos, stats.redos));
  if (stats.refused_steps > 0)
    print_row("",
              fmt::format("{} undos, redos and resets were dropped, because too many were pending",
                          stats.refused_steps));
  if (stats.forgotten_steps > 0)
    print_row("undo",
              fmt::format("keeps {} steps; the {} oldest were discarded, --undo-memory keeps more",
                          stats.undo_steps, stats.forgotten_steps));
}

void print_filter(const hand::FilterOptions& filter, const flow::LoopStats& stats) {
  if (filter.kind == hand::FilterKind::off) return;
  print_percentiles("filter delay", stats.filter_moving);
  namespace setting = flow::setting;
  print_row("",
            fmt::format("{}, {} {:g} {}, {} {:g}: for moving joints; {:.1f} ms at rest; adds to "
                        "the times above",
                        hand::name_of(filter.kind), setting::min_cutoff.words, filter.min_cutoff_hz,
                        setting::min_cutoff.unit, setting::beta.words, filter.beta_hz_per_rad_s,
                        to_milliseconds(stats.filter_worst.max())));
}

void print_injective(const RunOptions& options, const flow::LoopStats& stats) {
  const auto& deformer = options.loop.sculptor.deformer;
  if (!deformer.injective || deformer.csrbf.keeps_volume()) return;
  if (options.verbose)
    print_row("injective", fmt::format("max {} links per tick, bound in one step {:.3g}, min "
                                       "determinant {:.3g}; fingertips held apart in {} ticks",
                                       stats.max_links, stats.max_bound, stats.min_determinant,
                                       stats.held_apart_ticks));
  else if (stats.held_apart_ticks > 0)
    print_row("no folds", fmt::format("fingertips with crossing paths were held apart in {} ticks",
                                      cli::thousands(stats.held_apart_ticks)));
}

void print_clay(const flow::LoopStats& stats, double units_per_metre) {
  const flow::ClayState& clay = stats.clay;
  if (!clay.is_clay) return;
  print_row("clay",
            fmt::format("touched in {} ticks; max penetration {:.3f} mm, before it was corrected",
                        cli::thousands(stats.touching_ticks), stats.max_penetration_mm));
  if (!(clay.first_volume > 0.0)) {
    print_row("volume",
              "not kept: the surface is not closed; `nendo repair IN --out OUT` may close it");
    return;
  }
  const double cm3 = 1e6 / (units_per_metre * units_per_metre * units_per_metre);
  print_row("volume",
            fmt::format("{:.2f} cm3, initially {:.2f} cm3 ({:+.4f} %)", cm3 * clay.volume,
                        cm3 * clay.first_volume, 100.0 * (clay.volume / clay.first_volume - 1.0)));
}

void print_recordings(const std::vector<RecordingOutcome>& recordings) {
  for (const auto& [file, recorded] : recordings) {
    const std::string name = file.empty() ? "" : file + ", ";
    print_row("recording", recorded ? fmt::format("{}{} bytes, {} entries not recorded, {} kept",
                                                  name, cli::thousands(recorded->bytes),
                                                  recorded->lost, recorded->kept)
                                    : name + "not complete; see the error above");
  }
}

void print_published(const RunOutcome& outcome) {
  for (const auto& to : outcome.published) {
    if (const auto* segment = std::get_if<publish::SegmentCounts>(&to.counts))
      print_row("published",
                fmt::format("{}, {} ticks, {} bytes{}", to.target, segment->records,
                            cli::thousands(segment->bytes),
                            segment->is_locked ? "" : ", not locked in memory (see --mlockall)"));
    if (const auto* sent = std::get_if<publish::OscCounts>(&to.counts))
      print_row("published",
                fmt::format("{}, {} of {} ticks, {} datagrams, {} refused, {} ticks lost",
                            to.target, sent->sent, sent->records, sent->datagrams, sent->refused,
                            sent->lost));
    if (const auto* served = std::get_if<publish::VrpnCounts>(&to.counts))
      print_row("published",
                fmt::format("{}, {} of {} ticks, {} clients, {} refused, {} ticks missed by slow "
                            "clients, {} lost",
                            to.target, served->sent, served->records, served->clients,
                            served->refused, served->missed, served->lost));
  }
}

void print_shape(const RunOptions& options, const RunOutcome& outcome) {
  print_injective(options, outcome.stats);
  print_clay(outcome.stats, outcome.units_per_metre);
  print_row("vertices", fmt::format("{} per second ({} in the model)",
                                    cli::thousands(static_cast<double>(outcome.vertices) *
                                                   static_cast<double>(outcome.stats.ticks) /
                                                   outcome.elapsed_s),
                                    cli::thousands(outcome.vertices)));
}

void print_summary_text(const RunOptions& options, const std::vector<gloves::OpenHand>& hands,
                        const RunOutcome& outcome) {
  const auto& stats = outcome.stats;
  const auto settings =
      flow::settings_of(outcome.sculptor, options.filter, outcome.units_per_metre);
  cli::print("\nnendo {}: {:.1f} s{}\n", options.hands_only ? "serve" : "run", outcome.elapsed_s,
             options.hands_only ? "" : ", " + flow::in_words(settings, outcome.units_per_metre));
  for (const auto& hand : hands)
    print_hand(hand, outcome);
  if (!options.hands_only) print_holds(options, stats);
  print_row("ticks",
            fmt::format("{} at {:g} Hz, {} overruns, {} missed", cli::thousands(stats.ticks),
                        options.loop.rate_hz, stats.overruns, stats.missed));
  print_percentiles("wake-up", stats.wake_latency);
  print_percentiles("work per tick", stats.work);
  print_percentiles("end to end", stats.end_to_end);
  print_row("", options.hands_only ? "from the last byte of a sample to the hand's joints"
                                   : "from the last byte of a sample to the finished mesh");
  print_pose_latencies(stats);
  if (outcome.pictures) {
    print_percentiles("picture", outcome.pictures->whole);
    print_percentiles("preparing it", outcome.pictures->preparing);
    print_row("", "without what OpenGL draws");
  }
  print_filter(options.filter, stats);
  if (!options.hands_only) print_shape(options, outcome);
  print_recordings(outcome.recordings);
  print_published(outcome);
  if (!options.hands_only) print_row("result", outcome.result);
  if (!options.picture.empty()) print_row("picture", options.picture);
  std::fflush(stdout);
}

} // namespace

bool is_moved(const gloves::OpenHand& hand, const flow::LoopStats& stats) noexcept {
  return hand.wrist && stats.wrists[flow::Placement::index_of(hand.side)].tracked;
}

Progress progress_for(const RunOptions& options, const std::vector<gloves::OpenHand>& hands) {
  if (options.json) {
    return [next_s = 1.0](const flow::Frame& frame, double elapsed_s) mutable {
      if (elapsed_s < next_s) return;
      print_progress_json(frame, elapsed_s);
      next_s += 1.0;
    };
  }
  Uncalibrated uncalibrated{};
  for (const auto& hand : hands)
    uncalibrated[flow::Placement::index_of(hand.side)] = hand.uncalibrated;
  const bool terminal = cli::has_control_codes(STDERR_FILENO);
  return [terminal, uncalibrated, next_s = 2.0,
          duration_s = options.duration_s](const flow::Frame& frame, double elapsed_s) mutable {
    if (!terminal && elapsed_s < next_s) return;
    next_s += 2.0;
    std::string line = progress_line(frame, elapsed_s, duration_s, uncalibrated);
    if (terminal && fitting(line) != line)
      line = fitting(brief_progress_line(frame, elapsed_s, uncalibrated));
    std::cerr << (terminal ? "\r" + line + "\x1b[K" : line + "\n") << std::flush;
  };
}

void print_summary(const RunOptions& options, const std::vector<gloves::OpenHand>& hands,
                   const RunOutcome& outcome) {
  (options.json ? print_summary_json : print_summary_text)(options, hands, outcome);
}

} // namespace nendo::session
