#include "session/run_report_parts.hpp"

#include <algorithm>
#include <cstdio>
#include <numeric>

#include "session/range_report.hpp"

namespace nendo::session {
namespace {

std::string thousands(double value) {
  std::string digits = std::to_string(static_cast<long long>(value));
  for (auto at = static_cast<std::ptrdiff_t>(digits.size()) - 3; at > 0; at -= 3) {
    digits.insert(static_cast<std::size_t>(at), ",");
  }
  return digits;
}

void print_percentiles(const char* name, const flow::Histogram& histogram) {
  std::printf("  %-14s p50 %.3f ms, p90 %.3f ms, p99 %.3f ms, max %.3f ms\n", name,
              to_milliseconds(histogram.percentile(0.50)),
              to_milliseconds(histogram.percentile(0.90)),
              to_milliseconds(histogram.percentile(0.99)), to_milliseconds(histogram.max()));
}

// What the velocity gate kept out, and where most of it came from.
void print_spikes(const std::array<std::uint64_t, sensor_slots>& spikes) {
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

void print_filter(const hand::FilterOptions& filter, const flow::LoopStats& stats) {
  if (filter.kind == hand::FilterKind::off) return;
  print_percentiles("filter's lag", stats.filter_moving);
  std::printf("  %-14s %s, min cutoff %g Hz, beta %g: of the joints that move; %.1f ms at rest; "
              "comes on top of all these\n",
              "", std::string(hand::name_of(filter.kind)).c_str(), filter.min_cutoff_hz,
              filter.beta_hz_per_rad_s, to_milliseconds(stats.filter_worst.max()));
}

void print_injective(const RunOptions& options, const flow::LoopStats& stats) {
  if (!options.loop.sculptor.deformer.injective) return;
  std::printf("  %-14s at most %d links a tick, bound in one step %.3g, least determinant %.3g; "
              "fingertips held apart in %llu ticks\n",
              "injective", stats.most_links, stats.most_bound, stats.least_determinant,
              static_cast<unsigned long long>(stats.held_apart_ticks));
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

} // namespace

void print_summary_text(const RunOptions& options, const std::vector<gloves::OpenHand>& hands,
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
    if (hand.wearer.adapt) print_ranges(stats.ranges[slot], hand.glove->info().sensors);
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

} // namespace nendo::session
