#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include <spdlog/fmt/fmt.h>

#include "cli/svg_drawing.hpp"
#include "stress/report.hpp"

namespace nendo::stress {
namespace {

using std::chrono::nanoseconds;

constexpr const char* ink = "#1d2b3a";
constexpr const char* faint = "#8896a5";
constexpr const char* grid_line = "#e3e8ee";
constexpr const char* ran = "#2f7fc1";       // ticks that ran
constexpr const char* scheduled = "#e07a3f"; // ticks that were scheduled
constexpr const char* machine = "#aab4bf";   // the platform's floor

constexpr cli::SvgText heading{14, ink, "start", true};
constexpr cli::SvgText at_right{12, faint, "end"};
constexpr cli::SvgText below{12, faint, "middle"};

std::string time_text(double us) {
  if (us >= 1e6) return fmt::format("{:.3g} s", us / 1e6);
  if (us >= 1e3) return fmt::format("{:.3g} ms", us / 1e3);
  return us >= 1.0 ? fmt::format("{:.3g} \u00b5s", us) : fmt::format("{:.3g} ns", us * 1e3);
}

/// A rectangle of the page, and the ranges of its axes. The y axis is logarithmic.
struct Axes {
  double left, top, width, height;
  double x_low, x_high; ///< decades if `log_x`
  bool log_x;
  double y_low, y_high; ///< decades

  double x(double value) const {
    const double at = log_x ? std::log10(std::max(value, 1e-9)) : value;
    return left + width * std::clamp((at - x_low) / (x_high - x_low), 0.0, 1.0);
  }
  double y(double value) const {
    const double at = std::log10(std::max(value, 1e-9));
    return top + height * (1.0 - std::clamp((at - y_low) / (y_high - y_low), 0.0, 1.0));
  }
  double bottom() const { return top + height; }
};

constexpr int bins_per_decade = 20;
constexpr double min_us_decade = -2.0; // 10 ns
constexpr double max_us_decade = 5.0;  // 100 ms
constexpr std::size_t bin_count =
    static_cast<std::size_t>((max_us_decade - min_us_decade) * bins_per_decade);

std::vector<double> binned(const flow::Histogram& histogram) {
  std::vector<double> bins(bin_count, 0.0);
  histogram.for_each([&](nanoseconds value, std::uint64_t count) {
    const double decade = std::log10(std::max(to_microseconds(value), 1e-9));
    const double at = std::floor((decade - min_us_decade) * bins_per_decade);
    bins[static_cast<std::size_t>(std::clamp(at, 0.0, static_cast<double>(bin_count - 1)))] +=
        static_cast<double>(count);
  });
  return bins;
}

double left_of(std::size_t bin) {
  return std::pow(10.0, min_us_decade + static_cast<double>(bin) / bins_per_decade);
}

std::string outline(const Axes& axes, const std::vector<double>& bins) {
  const auto any = [](double count) { return count > 0.0; };
  const auto first = std::find_if(bins.begin(), bins.end(), any) - bins.begin();
  const auto last = bins.rend() - std::find_if(bins.rbegin(), bins.rend(), any);
  std::string points;
  for (auto at = first; at < last; ++at) {
    const auto bin = static_cast<std::size_t>(at);
    for (const double x : {left_of(bin), left_of(bin + 1)})
      points += cli::svg_point(axes.x(x), axes.y(bins[bin]));
  }
  return points;
}

void draw_decades(cli::SvgDrawing& drawing, const Axes& axes, bool times_on_y) {
  const auto whole = [](double decade) { return static_cast<int>(std::ceil(decade)); };
  for (int decade = whole(axes.y_low); decade <= whole(axes.y_high); ++decade) {
    const double value = std::pow(10.0, decade);
    const double y = axes.y(value);
    drawing.line(axes.left, y, axes.left + axes.width, y, grid_line);
    drawing.text(axes.left - 8, y + 4, times_on_y ? time_text(value) : fmt::format("{:.0f}", value),
                 {11, faint, "end"});
  }
  for (int decade = whole(axes.x_low); axes.log_x && decade <= whole(axes.x_high); ++decade) {
    const double x = axes.x(std::pow(10.0, decade));
    drawing.line(x, axes.top, x, axes.bottom(), grid_line);
    drawing.text(x, axes.bottom() + 18, time_text(std::pow(10.0, decade)), {11, faint, "middle"});
  }
}

void draw_percentiles(cli::SvgDrawing& drawing, const Axes& axes, const flow::Histogram& lateness) {
  struct Mark {
    const char* name;
    double fraction;
  };
  double row = axes.top + 12;
  double last_x = -1e3;
  for (const Mark& mark : {Mark{"p50", 0.5}, Mark{"p99", 0.99}, Mark{"p99.9", 0.999},
                           Mark{"p99.99", 0.9999}, Mark{"max", 1.0}}) {
    const double us = to_microseconds(lateness.percentile(mark.fraction));
    const double x = axes.x(us);
    row = x - last_x < 110 ? row + 16 : axes.top + 12; // labels do not cover each other
    last_x = x;
    drawing.line(x, axes.top, x, axes.bottom(), scheduled, 1.0, "3 3");
    const bool at_edge = x > axes.left + axes.width - 110;
    drawing.text(at_edge ? x - 4 : x + 4, row, std::string(mark.name) + " " + time_text(us),
                 {11, ink, at_edge ? "end" : "start"});
  }
}

void draw_histogram(cli::SvgDrawing& drawing, const StressOutcome& outcome) {
  const Distribution& lateness = outcome.tally[Measure::lateness];
  const auto all = binned(lateness.corrected);
  const auto those_ran = binned(lateness.raw);
  const auto floor = binned(outcome.floor.gaps);
  double most = 10.0;
  for (const auto* bins : {&all, &floor})
    most = std::max(most, *std::max_element(bins->begin(), bins->end()));
  const Axes axes{80,   130,           1080,
                  230,  min_us_decade, max_us_decade,
                  true, -0.4,          std::ceil(std::log10(most))}; // a single tick shows
  drawing.text(80, 112, "How late ticks were", heading);
  draw_decades(drawing, axes, false);
  for (std::size_t k = 0; k < those_ran.size(); ++k) {
    if (those_ran[k] <= 0.0) continue;
    const double x = axes.x(left_of(k));
    drawing.box(x, axes.y(those_ran[k]), axes.x(left_of(k + 1)) - x,
                std::max(1.0, axes.bottom() - axes.y(those_ran[k])), ran, 0.75);
  }
  drawing.path(outline(axes, floor), machine, 1.5);
  drawing.path(outline(axes, all), scheduled, 1.8);
  draw_percentiles(drawing, axes, lateness.corrected);
}

void draw_trace(cli::SvgDrawing& drawing, const StressOutcome& outcome) {
  const LatenessTrace& trace = outcome.tally.trace();
  const double length_s =
      to_seconds(trace.slice_length()) * static_cast<double>(trace.slices().size());
  double min_us = 10.0;
  double max_us = 100.0;
  for (const auto& slice : trace.slices()) {
    if (slice.count == 0) continue;
    min_us = std::min(min_us, to_microseconds(slice.sum) / static_cast<double>(slice.count));
    max_us = std::max(max_us, to_microseconds(slice.max));
  }
  const Axes axes{80,
                  450,
                  1080,
                  200,
                  0.0,
                  std::max(length_s, 1e-3),
                  false,
                  std::max(min_us_decade, std::floor(std::log10(std::max(min_us, 1e-3)))),
                  std::ceil(std::log10(max_us))};
  drawing.text(80, 432, "When", heading);
  draw_decades(drawing, axes, true);
  const double slice_s = to_seconds(trace.slice_length());
  const double width = std::max(1.0, axes.x(slice_s) - axes.x(0.0));
  std::string means;
  for (std::size_t k = 0; k < trace.slices().size(); ++k) {
    const auto& slice = trace.slices()[k];
    if (slice.count == 0) continue;
    const double x = axes.x(slice_s * static_cast<double>(k));
    const double mean_us = to_microseconds(slice.sum) / static_cast<double>(slice.count);
    const double top = axes.y(to_microseconds(slice.max));
    drawing.box(x, top, width, std::max(1.0, axes.y(mean_us) - top), scheduled, 0.6);
    means += cli::svg_point(x + width / 2, axes.y(mean_us));
  }
  drawing.path(means, ran, 1.8);
  for (int k = 0; k <= 5; ++k) {
    const double at_s = length_s * k / 5.0;
    drawing.text(axes.x(at_s), axes.bottom() + 18, fmt::format("{:.3g} s", at_s),
                 {11, faint, "middle"});
  }
}

/// Draws the key from the right, the last entry first.
void draw_key(cli::SvgDrawing& drawing, double y,
              std::initializer_list<std::pair<const char*, const char*>> entries) {
  double right = 1160;
  for (const auto& [colour, name] : entries) {
    right -= 6.6 * static_cast<double>(std::string_view(name).size());
    drawing.text(right, y, name, {12, faint});
    drawing.box(right - 20, y - 9, 14, 9, colour, 0.8);
    right -= 44;
  }
}

std::string summary(const StressOptions& options, const StressOutcome& outcome) {
  return fmt::format("{} ticks at {:g} Hz in {:.0f} s; {} deadlines missed; policy {}{}{}",
                     outcome.tally.ticks(), options.run.loop.rate_hz, outcome.elapsed_s,
                     outcome.missed, flow::describe_policy(options.run.loop),
                     options.load.empty() ? "" : "; under load",
                     outcome.broke ? "; ended by --break" : "");
}

} // namespace

std::string stress_picture(const StressOptions& options, const StressOutcome& outcome) {
  cli::SvgDrawing drawing(1200, 720);
  drawing.text(40, 46, "nendo stress", {24, ink, "start", true});
  drawing.text(40, 72, summary(options, outcome), {14, ink});
  const Environment& about = outcome.environment;
  drawing.text(1160, 46, "Linux " + about.kernel + (about.hypervisor ? ", virtual machine" : ""),
               at_right);
  drawing.text(1160, 66, about.processor, at_right);
  std::string rights;
  for (const auto& grant : outcome.grants) {
    if (!grant.granted) rights += (rights.empty() ? "refused: " : ", ") + grant.wanted;
  }
  drawing.text(1160, 86, rights, at_right);
  draw_histogram(drawing, outcome);
  draw_key(drawing, 112,
           {{machine, "gaps that this machine leaves"},
            {scheduled, "every tick that was due"},
            {ran, "ticks that ran"}});
  draw_trace(drawing, outcome);
  draw_key(drawing, 432, {{scheduled, "up to the latest"}, {ran, "mean"}});
  drawing.text(600, 396, "lateness, and how many ticks had it", below);
  drawing.text(600, 702, "since the start", below);
  return std::move(drawing).finished();
}

} // namespace nendo::stress
