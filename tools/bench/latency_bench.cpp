// nendo bench driver: the driver's latency, beside that of the least that any program can do.

#include <array>

#include <nlohmann/json.hpp>

#include <nendo/flow/histogram.hpp>

#include "bench/bench.hpp"
#include "bench/latency_probe.hpp"
#include "cli/cli.hpp"
#include "cli/print.hpp"

namespace nendo::bench::latency_bench {
namespace {

struct DriverOptions {
  LatencyOptions latency;
  bool json = false;
};

struct Column {
  const char* name;
  double fraction;
};
constexpr std::array columns{Column{"p50", 0.50}, Column{"p90", 0.90}, Column{"p99", 0.99},
                             Column{"p99.9", 0.999}};

double ratio(const flow::Histogram& driver, const flow::Histogram& bare, double fraction) {
  return to_microseconds(driver.percentile(fraction)) /
         std::max(to_microseconds(bare.percentile(fraction)), 0.001);
}

void print_json(const char* line, const flow::Histogram& driver, const flow::Histogram& bare) {
  const auto row = [](const flow::Histogram& histogram) {
    nlohmann::ordered_json values{{"records", histogram.count()},
                                  {"min", to_microseconds(histogram.min())}};
    for (const Column& column : columns)
      values[column.name] = to_microseconds(histogram.percentile(column.fraction));
    values["max"] = to_microseconds(histogram.max());
    return values;
  };
  cli::print_line(
      {{"line", line},
       {"driver_us", row(driver)},
       {"bare_us", row(bare)},
       {"ratio", {{"p50", ratio(driver, bare, 0.5)}, {"p99", ratio(driver, bare, 0.99)}}}});
}

void print_row(const char* name, const flow::Histogram& histogram) {
  cli::print("  {:22} {:8.1f}", name, to_microseconds(histogram.min()));
  for (const Column& column : columns)
    cli::print(" {:8.1f}", to_microseconds(histogram.percentile(column.fraction)));
  cli::print(" {:8.1f}\n", to_microseconds(histogram.max()));
}

void print_text(const char* line, const flow::Histogram& driver, const flow::Histogram& bare) {
  cli::print("{}, {} records: from the write of the last byte to the sample in the ring, us\n",
             line, driver.count());
  cli::print("  {:22} {:>8}", "", "min");
  for (const Column& column : columns)
    cli::print(" {:>8}", column.name);
  cli::print(" {:>8}\n", "max");
  print_row("bare poll() and read()", bare);
  print_row("CyberGlove driver", driver);
  cli::print("  driver / bare: {:.2f} at the median, {:.2f} at the 99th percentile\n",
             ratio(driver, bare, 0.5), ratio(driver, bare, 0.99));
}

int bench_driver(DriverOptions& options) {
  if (options.latency.records == 0) {
    return cli::report({Errc::usage, "--records: use 1 or more"});
  }
  cli::install_stop_signals();
  constexpr std::array<std::pair<Line, const char*>, 2> lines{
      {{Line::pseudo_terminal, "pseudo-terminal"}, {Line::socket_pair, "socket pair"}}};
  for (const auto& [line, name] : lines) {
    flow::Histogram driver;
    flow::Histogram bare;
    options.latency.line = line;
    const auto measured = measure_latency(
        options.latency,
        {[&](auto time) { driver.record(time); }, [&](auto time) { bare.record(time); }},
        cli::stop_requested());
    if (!measured) return cli::report(measured.error());
    options.json ? print_json(name, driver, bare) : print_text(name, driver, bare);
  }
  return 0;
}

} // namespace
} // namespace nendo::bench::latency_bench

void nendo::bench::add_latency(cli::Command& bench) {
  using namespace latency_bench;
  cli::Command command = bench.add_command(
      "driver",
      "Measures the latency of the CyberGlove driver, beside that of a bare poll()+read() thread");
  DriverOptions& options = command.on_chosen<DriverOptions>(bench_driver);
  command.add_option("--records", options.latency.records, "Number of records on each line");
  command.add_rate("--rate", options.latency.rate_hz, "Records per second, 1 to 480");
  command.add_flag("--json", options.json, "One JSON object per line");
}
