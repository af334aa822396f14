#include "session/run_report.hpp"

#include <cstdio>
#include <iostream>

#include <unistd.h>

#include "session/run_report_parts.hpp"

namespace nendo::session {
namespace {

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
                static_cast<unsigned long long>(frame.ticks_run),
                static_cast<unsigned long long>(frame.missed));
  line += text;
  for (const Side side : {Side::left, Side::right}) {
    const auto& hand = frame.hands[flow::Placement::index_of(side)];
    if (!hand.present) continue;
    line += "  " + std::string(name_of(side)) + ": ";
    line += hand.silent ? "silent" : std::to_string(hand.samples) + " samples";
  }
  if (!frame.held) line += "  let go";
  if (frame.chain.held_pairs > 0) line += "  fingertips held apart";
  return line;
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

void print_summary(const RunOptions& options, const std::vector<gloves::OpenHand>& hands,
                   const RunOutcome& outcome) {
  if (options.json) {
    print_summary_json(options, hands, outcome);
  } else {
    print_summary_text(options, hands, outcome);
  }
}

} // namespace nendo::session
