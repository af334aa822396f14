// nendo bench clay: what it takes to press clay with hands, beside a plain program of the method.

#include <cstdio>
#include <map>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include <nendo/deform/mesh_file.hpp>

#include "bench/bench.hpp"
#include "bench/clay_kneading.hpp"
#include "bench/clay_trial.hpp"
#include "bench/simd_choice.hpp"
#include "cli/cli.hpp"
#include "cli/print.hpp"

namespace nendo::bench::clay_bench {
namespace {

struct Options {
  std::string made_shape;
  std::string save;
  std::string simd;
  std::string only;
  bool short_form = false;
  bool refines = false;
  bool json = false;
};

struct Row {
  const char* name;
  ClayTrialOptions trial;
  bool is_plain = false;
};

void print_json(const Row& row, const ClayTrial& trial) {
  cli::print_line({{"row", row.name},
                   {"plain", row.is_plain},
                   {"vertices", trial.vertices},
                   {"mean_edge_mm", trial.mean_edge_mm},
                   {"hands", row.trial.hands},
                   {"speed_m_s", row.trial.speed_m_s},
                   {"radius_mm", row.trial.radius_mm},
                   {"ticks", trial.ticks},
                   {"constraints", trial.constraints},
                   {"max_constraints", trial.max_constraints},
                   {"passes", trial.passes},
                   {"distances", trial.distances},
                   {"mean_us", trial.mean_us},
                   {"p99_us", trial.p99_us},
                   {"worst_us", trial.worst_us},
                   {"penetration_p99_mm", trial.penetration_p99_mm},
                   {"penetration_p99_of_edge", trial.penetration_p99_mm / trial.mean_edge_mm},
                   {"inside_p99_mm", trial.inside_p99_mm},
                   {"worst_volume", trial.worst_volume},
                   {"last_volume", trial.last_volume},
                   {"worst_behind_mm", trial.max_remaining_path_mm}});
}

void print_text(const Row& row, const ClayTrial& trial) {
  cli::print("{:26} {:8} {:6.1f} {:4} {:7.1f} {:8.0f} {:8.2f} {:8.2f} {:9.4f} {:8.4f} {:7.3f} "
             "{:8.4f} {:6.1f}\n",
             row.name, trial.vertices, trial.constraints, trial.max_constraints, trial.passes,
             trial.distances / 1e3, trial.mean_us / 1e3, trial.p99_us / 1e3,
             trial.penetration_p99_mm / trial.mean_edge_mm,
             trial.inside_p99_mm / trial.mean_edge_mm, 100.0 * trial.worst_volume,
             100.0 * trial.last_volume, trial.max_remaining_path_mm);
  std::fflush(stdout);
}

std::vector<Row> rows_of(bool short_form) {
  if (short_form)
    return {{"both hands, 0.5 m/s", {.level = 4}}, {"the same, plain", {.level = 4}, true}};
  constexpr int scenes = 30; // of a dozen ticks each
  return {{"both hands, 0.5 m/s", {.judges_inside = true, .scenes = scenes}},
          {"the same, 90 ticks per second", {.rests = true, .scenes = scenes}},
          {"the same, plain", {.judges_inside = true}, true},
          {"the same, no volume kept", {.keeps_volume = false, .scenes = scenes}},
          {"0.075 m/s", {.speed_m_s = 0.075, .scenes = 4}},
          {"0.075 m/s, plain", {.speed_m_s = 0.075}, true},
          {"one hand", {.hands = 1, .scenes = scenes}},
          {"radius 20 mm", {.radius_mm = 20.0, .scenes = scenes}},
          {"radius 15 mm", {.radius_mm = 15.0, .scenes = scenes}},
          {"radius 10 mm", {.radius_mm = 10.0, .scenes = scenes}},
          {"radius 10 mm, more places", {.radius_mm = 10.0, .max_constraints = 1024}},
          {"radius 40 mm", {.radius_mm = 40.0, .scenes = scenes}},
          {"2.6 thousand vertices", {.level = 4, .scenes = scenes}},
          {"10 thousand vertices", {.level = 5, .scenes = scenes}},
          {"164 thousand vertices", {.level = 7, .scenes = scenes}},
          {"655 thousand vertices", {.level = 8, .scenes = 4}},
          {"2.6 million vertices", {.level = 9}}};
}

/// Makes one shape, and writes it.
int make_shape(const Options& options) {
  const std::map<std::string, KneadedShape> shapes{{"cake", KneadedShape::cake},
                                                   {"bowl", KneadedShape::bowl},
                                                   {"nose", KneadedShape::nose},
                                                   {"sausage", KneadedShape::sausage}};
  const auto shape = shapes.find(options.made_shape);
  if (shape == shapes.end())
    return cli::report({Errc::usage, "--make " + options.made_shape +
                                         ": no such shape; use cake, bowl, nose or sausage"});
  const KneadedClay made =
      knead(shape->second, {.level = options.short_form ? 4 : 6, .refines = options.refines});
  const Eigen::Vector3d size = extents_mm(made.shape.vertices);
  cli::print("{}: {} vertices; {:.2f} ms per tick, p99 {:.2f}; penetration p99 {:.4f} mm; volume "
             "error {:.4f} % at most, {:.4f} % at the end; at most {} places held; turned by "
             "{:.0f} degrees; {:.0f} x {:.0f} x {:.0f} mm\n",
             options.made_shape, static_cast<std::size_t>(made.shape.vertices.cols()),
             made.mean_us / 1e3, made.p99_us / 1e3, made.penetration_p99_mm,
             100.0 * made.worst_volume, 100.0 * made.last_volume, made.max_held,
             made.turned_rad * 180.0 / std::numbers::pi, size.x(), size.y(), size.z());
  if (options.save.empty()) return 0;
  const auto written = deform::write_mesh(options.save, made.shape);
  return written ? 0 : cli::report(written.error());
}

int bench_clay(const Options& options) {
  if (const auto chosen = choose_simd(options.simd); !chosen) return cli::report(chosen.error());
  if (!options.made_shape.empty()) return make_shape(options);
  std::vector<Row> rows = rows_of(options.short_form);
  std::erase_if(rows, [&](const Row& row) {
    return std::string_view(row.name).find(options.only) == std::string_view::npos;
  });
  if (rows.empty())
    return cli::report({Errc::usage, "--only " + options.only + ": no row has this in its name"});
  if (!options.json)
    cli::print("two hands press a ball of 120 mm by 25 mm each, scrape it, and leave, at 90 Hz\n"
               "constraints: mean and max per pass; distances in thousands; times in ms per tick; "
               "penetration before the last\npush, and depth inside triangles after it: p99, in "
               "mean edges; volume error in %: max, and at the end; lag in mm\n"
               "{:26} {:>8} {:>6} {:>4} {:>7} {:>8} {:>8} {:>8} {:>9} {:>8} {:>7} {:>8} {:>6}\n",
               "", "vertices", "constr", "max", "passes", "dist k", "mean", "p99", "left", "inside",
               "volume", "at end", "lag");
  for (const Row& row : rows) {
    const ClayTrial trial = row.is_plain ? measure_plain_clay(row.trial) : measure_clay(row.trial);
    options.json ? print_json(row, trial) : print_text(row, trial);
  }
  return 0;
}

} // namespace
} // namespace nendo::bench::clay_bench

void nendo::bench::add_clay(cli::Command& bench) {
  using namespace clay_bench;
  cli::Command command =
      bench.add_command("clay", "Measures clay that whole hands press, beside a plain program");
  Options& options = command.on_chosen<Options>(bench_clay);
  command.add_option(
      "--make", options.made_shape,
      "Knead a ball into a shape, and measure only that: cake, bowl, nose or sausage");
  command.add_option("--save", options.save,
                     "Where to write the shape of --make, .obj, .ply or .stl");
  command.add_flag("--refine", options.refines,
                   "With --make: refine the triangles as the shape changes");
  add_simd_option(command, options.simd);
  command.add_option("--only", options.only, "Measure only rows with this in their names");
  command.add_flag("--short", options.short_form, "Measure only a small ball");
  command.add_flag("--json", options.json, "One JSON object per line");
}
