#include "takes/recording_report.hpp"

#include <chrono>
#include <cstdio>
#include <utility>

#include <nlohmann/json.hpp>

#include <nendo/base/text.hpp>
#include <nendo/driver/record_counts.hpp>
#include <nendo/hand/calibration_file.hpp>

#include "cli/cli.hpp"

namespace nendo::takes {
namespace {

using nlohmann::ordered_json;
using recording::GloveSummary;
using recording::TakeSummary;

unsigned long long number(std::uint64_t value) {
  return value;
}

std::string begun_of(const TakeSummary& summary) {
  if (summary.setup.begun == decltype(summary.setup.begun){}) return {}; // that chunk is not whole
  return hand::rfc3339(std::chrono::floor<std::chrono::seconds>(summary.setup.begun));
}

double pause_s(const GloveSummary& glove) {
  return to_seconds(glove.longest_pause);
}

void print_glove(const driver::GloveInfo& info, const GloveSummary& glove) {
  std::printf("  %-12s %s, %s; %llu samples (%.1f/s), longest pause %.3f s\n",
              (std::string(name_of(info.side)) + " glove").c_str(), info.source.c_str(),
              info.model.c_str(), number(glove.samples), glove.rate_hz(), pause_s(glove));
  const std::string line =
      glove.sent ? driver::in_words(*glove.sent) : "what was missed on the line was not counted";
  std::printf("  %-12s %s; %llu delivered, but not recorded\n", "", line.c_str(),
              number(glove.lost));
}

void print_tracker(const recording::RecordedTracker& tracker) {
  std::printf("  %-12s %s, %s; station %u\n",
              (std::string(name_of(tracker.side)) + " wrist").c_str(), tracker.info.source.c_str(),
              tracker.info.model.c_str(), unsigned{tracker.station});
}

/// A take in layers plays some joints of a hand over what was recorded before.
void print_layer(const flow::HandInput& hand, const GloveSummary& glove) {
  std::printf("  %-12s a layer: plays %s; ", "",
              flow::in_words(hand.side, hand.layer->joints).c_str());
  if (glove.punches == 0)
    std::printf("%s all the time\n", hand.layer->on ? "in" : "out");
  else
    std::printf("%s at first, punched in or out %llu times\n", hand.layer->on ? "in" : "out",
                number(glove.punches));
}

void print_loop(const TakeSummary& summary) {
  const recording::LoopSetup& loop = *summary.setup.loop;
  std::printf("  %-12s %s, %g Hz, %s; %llu ticks, %llu missed;", "loop",
              std::string(flow::name_of(loop.options.sculptor.mode)).c_str(), loop.options.rate_hz,
              printable(loop.mesh).c_str(), number(summary.ticks), number(summary.missed));
  for (const flow::Request request : flow::requests) {
    std::printf(" %llu %s%s", number(summary.requests[static_cast<std::size_t>(request)]),
                std::string(flow::name_of(request)).c_str(),
                request == flow::requests.back() ? "" : ",");
  }
  const std::pair<std::uint64_t, const char*> counts[]{
      {summary.wrist_moves, "wrist moves"},
      {summary.poses, "poses of trackers"},
      {summary.settings_changes, "changes of settings"},
      {summary.model_changes, "changes of the model"},
      {summary.puppet_changes, "changes of the puppet"},
      {summary.shapes, "shapes"}};
  for (const auto& [count, what] : counts)
    if (count > 0) std::printf(", %llu %s", number(count), what);
  std::printf("\n");
}

/// The first of them; more do not help anybody who reads a page of text.
void print_marks(const TakeSummary& summary) {
  constexpr std::size_t most = 20;
  std::printf("  %-12s", "marks");
  for (std::size_t at = 0; at < summary.marks.size() && at < most; ++at)
    std::printf("%s %zu at %.2f s", at == 0 ? "" : ",", at + 1, to_seconds(summary.marks[at]));
  if (summary.marks.size() > most) std::printf(", and %zu more", summary.marks.size() - most);
  std::printf("\n");
}

ordered_json gloves_json(const TakeSummary& summary) {
  ordered_json gloves = ordered_json::array();
  for (std::size_t at = 0; at < summary.gloves.size(); ++at) {
    const driver::GloveInfo& info = summary.setup.gloves[at];
    const GloveSummary& glove = summary.gloves[at];
    ordered_json line{
        {"hand", name_of(info.side)},       {"source", info.source},      {"model", info.model},
        {"samples", glove.samples},         {"rate_hz", glove.rate_hz()}, {"lost", glove.lost},
        {"longest_pause_s", pause_s(glove)}};
    const auto counts = driver::by_name(glove.sent.value_or(driver::RecordCounts{}));
    for (const auto& [name, count] : counts) {
      ordered_json& value = line[std::string(name)];
      if (glove.sent && count) value = *count; // otherwise null: unknown
    }
    const auto& hands = summary.setup.hands;
    line["layer"] = nullptr; // of the whole hand
    if (at < hands.size() && hands[at].layer)
      line["layer"] = {{"plays", flow::in_words(hands[at].side, hands[at].layer->joints)},
                       {"in_at_first", hands[at].layer->on},
                       {"punches", glove.punches}};
    gloves.push_back(std::move(line));
  }
  return gloves;
}

ordered_json trackers_json(const TakeSummary& summary) {
  ordered_json trackers = ordered_json::array();
  for (const auto& [side, station, info] : summary.setup.trackers)
    trackers.push_back({{"hand", name_of(side)},
                        {"source", info.source},
                        {"model", info.model},
                        {"station", station}});
  return trackers;
}

ordered_json loop_json(const TakeSummary& summary) {
  if (!summary.setup.loop) return nullptr;
  const recording::LoopSetup& loop = *summary.setup.loop;
  ordered_json line{{"mode", flow::name_of(loop.options.sculptor.mode)},
                    {"rate_hz", loop.options.rate_hz},
                    {"mesh", loop.mesh},
                    {"vertices", loop.mesh_sum.vertices},
                    {"ticks", summary.ticks},
                    {"missed", summary.missed}};
  for (const flow::Request request : flow::requests)
    line["requests"][std::string(flow::name_of(request))] =
        summary.requests[static_cast<std::size_t>(request)];
  line["wrist_moves"] = summary.wrist_moves;
  line["poses"] = summary.poses;
  line["settings_changes"] = summary.settings_changes;
  line["model_changes"] = summary.model_changes;
  line["puppet_changes"] = summary.puppet_changes;
  line["shapes"] = summary.shapes;
  line["marks_s"] = ordered_json::array();
  for (const HostClock::duration mark : summary.marks)
    line["marks_s"].push_back(to_seconds(mark));
  return line;
}

} // namespace

void print_take(const std::string& file, const TakeSummary& summary) {
  const recording::Setup& setup = summary.setup;
  const std::string begun = begun_of(summary);
  std::printf("%s: begun %s, %.1f s%s%s%s%s; %llu bytes\n", file.c_str(),
              begun.empty() ? "at an unknown time" : begun.c_str(), to_seconds(summary.duration()),
              setup.program.empty() ? "" : ", by ", printable(setup.program).c_str(),
              setup.wearer.empty() ? "" : ", worn by ", printable(setup.wearer).c_str(),
              number(summary.bytes));
  for (std::size_t at = 0; at < summary.gloves.size(); ++at) {
    print_glove(setup.gloves[at], summary.gloves[at]);
    if (at < setup.hands.size() && setup.hands[at].layer)
      print_layer(setup.hands[at], summary.gloves[at]);
  }
  for (const recording::RecordedTracker& tracker : setup.trackers)
    print_tracker(tracker);
  if (setup.loop)
    print_loop(summary);
  else if (summary.poses > 0)
    std::printf("  %-12s %llu\n", "poses", number(summary.poses));
  if (!summary.marks.empty()) print_marks(summary);
  if (summary.gaps > 0)
    std::printf("  %-12s %llu, of %llu entries that are counted\n", "gaps", number(summary.gaps),
                number(summary.missing));
  if (!summary.ending) std::printf("  %-12s it was cut off; what there is counts\n", "end");
  if (!summary.is_whole()) std::printf("  %-12s `nendo recording check` shows where\n", "damage");
  std::fflush(stdout);
}

void print_take_json(const std::string& file, const TakeSummary& summary) {
  const std::string begun = begun_of(summary);
  const ordered_json line{{"file", file},
                          {"begun", begun.empty() ? ordered_json() : ordered_json(begun)},
                          {"duration_s", to_seconds(summary.duration())},
                          {"program", summary.setup.program},
                          {"wearer", summary.setup.wearer},
                          {"bytes", summary.bytes},
                          {"gloves", gloves_json(summary)},
                          {"trackers", trackers_json(summary)},
                          {"poses", summary.poses},
                          {"loop", loop_json(summary)},
                          {"gaps", summary.gaps},
                          {"missing_entries", summary.missing},
                          {"ended", summary.ending.has_value()},
                          {"whole", summary.is_whole()}};
  cli::print_line(line);
}

void print_damages(const TakeSummary& summary) {
  for (const auto& damage : summary.damages) {
    std::printf("  at byte %llu: %s", number(damage.offset), damage.what.c_str());
    if (damage.bytes > 0) std::printf(", %llu bytes of no use", number(damage.bytes));
    std::printf("\n");
  }
  if (summary.damage_count > summary.damages.size())
    std::printf("  and %llu more\n", number(summary.damage_count - summary.damages.size()));
  if (summary.unknown_entries > 0)
    std::printf("  %llu chunks or entries that no nendo writes\n", number(summary.unknown_entries));
  std::uint64_t turned = summary.ticks_out_of_order;
  for (const auto& glove : summary.gloves)
    turned += glove.out_of_order;
  if (turned > 0) std::printf("  %llu numbers of ticks or samples do not grow\n", number(turned));
  if (!summary.counts_agree) std::printf("  there is not what its end says that there is\n");
  std::fflush(stdout);
}

} // namespace nendo::takes
