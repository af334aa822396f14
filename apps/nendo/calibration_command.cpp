// nendo calibration: lists, shows, compares and removes the files of nendo calibrate.
// calibration_exchange.cpp has import and export.

#include <algorithm>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include <nendo/base/text.hpp>
#include <nendo/sculpting/find_wearer.hpp>

#include "cli/cli.hpp"
#include "cli/figures.hpp"
#include "gloves/glove_json.hpp"
#include "nendo/commands.hpp"

namespace nendo::app::calibration_command {
namespace {

using hand::StoredCalibration;
using hand::WearerCalibration;
using nlohmann::ordered_json;

struct Options {
  std::string name;
  std::string other;
  bool json = false;
};

ordered_json summary_json(const StoredCalibration& file) {
  const WearerCalibration& wearer = file.wearer;
  return {{"user", wearer.user},
          {"hand", name_of(wearer.side)},
          {"glove_model", wearer.glove_model},
          {"glove_serial", wearer.glove_serial},
          {"made", hand::rfc3339(wearer.made)},
          {"method", wearer.method},
          {"path", file.path.string()}};
}

ordered_json sensors_json(const WearerCalibration& wearer) {
  ordered_json sensors = ordered_json::object();
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    const auto& line = wearer.calibration.sensors[slot];
    if (line.gain_rad_per_count == 0.0) continue;
    ordered_json& sensor = sensors[std::string(sensor_names[slot])];
    sensor = {{"gain_rad_per_count", line.gain_rad_per_count},
              {"offset_counts", line.offset_counts}};
    const auto& quality = wearer.quality[slot];
    if (!quality) continue;
    sensor["residual_rad"] = quality->residual_rad;
    sensor["min_counts"] = quality->min_counts;
    sensor["max_counts"] = quality->max_counts;
    sensor["confidence"] = quality->confidence;
  }
  return sensors;
}

void print_table(const std::vector<std::vector<std::string>>& rows) {
  std::vector<std::size_t> widths;
  for (const auto& row : rows) {
    widths.resize(std::max(widths.size(), row.size()));
    for (std::size_t k = 0; k < row.size(); ++k)
      widths[k] = std::max(widths[k], row[k].size());
  }
  for (const auto& row : rows) {
    std::string line;
    for (std::size_t k = 0; k < row.size(); ++k) {
      line += printable(row[k]);
      if (k + 1 < row.size()) line.append(widths[k] - row[k].size() + 2, ' ');
    }
    std::cout << line << '\n';
  }
}

Result<void> list(const Options& options) {
  const auto stored = sculpting::stored_calibrations(cli::note);
  std::vector<std::vector<std::string>> rows{
      {"user", "hand", "glove", "made", "method", "in use", "path"}};
  for (const auto& file : stored.files) {
    const bool in_force = is_active_calibration(file, stored.files);
    if (options.json) {
      ordered_json line = summary_json(file);
      line["shared"] = file.shared;
      line["in_force"] = in_force;
      cli::print_line(line);
      continue;
    }
    const WearerCalibration& wearer = file.wearer;
    rows.push_back({wearer.user, std::string(name_of(wearer.side)),
                    wearer.glove_serial.empty() ? "any" : wearer.glove_serial,
                    hand::rfc3339(wearer.made), wearer.method, in_force ? "yes" : "no",
                    file.path.string()});
  }
  if (options.json) return {};
  if (rows.size() > 1)
    print_table(rows);
  else
    cli::note("no calibration is stored; `nendo calibrate GLOVE --user NAME` makes one, and `nendo "
              "calibration import` reads one of another program");
  return {};
}

void show_text(const StoredCalibration& file) {
  const WearerCalibration& wearer = file.wearer;
  std::cout << sculpting::title_of(wearer) << '\n'
            << printable("made " + hand::rfc3339(wearer.made) + " (" + wearer.method + "), " +
                         (wearer.glove_model.empty() ? "any model" : wearer.glove_model) + ", " +
                         file.path.string())
            << "\n\n";
  const double max_count = wearer.counts.max_count;
  std::vector<std::vector<std::string>> rows{
      {"sensor", "gain rad/count", "offset counts", "deg at 0", "deg at full", "residual deg"}};
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    const auto& line = wearer.calibration.sensors[slot];
    if (line.gain_rad_per_count == 0.0) continue;
    const auto at = [&](double count) {
      return to_degrees(line.gain_rad_per_count * (count - line.offset_counts));
    };
    const auto& quality = wearer.quality[slot];
    rows.push_back({std::string(sensor_names[slot]), cli::fixed(line.gain_rad_per_count, 5),
                    cli::fixed(line.offset_counts, 1), cli::fixed(at(0.0), 1),
                    cli::fixed(at(max_count), 1),
                    quality ? cli::fixed(to_degrees(quality->residual_rad), 1) : "-"});
  }
  print_table(rows);
  if (wearer.left_out.bits != 0)
    std::cout << "left out, because they are stuck: "
              << sculpting::sensors_in_words(wearer.left_out) << '\n';
}

Result<void> show(const Options& options) {
  const auto file = sculpting::named_calibration(options.name, cli::note);
  if (!file) return file.error();
  if (!options.json) {
    show_text(*file);
    return {};
  }
  const WearerCalibration& wearer = file->wearer;
  ordered_json line = summary_json(*file);
  line["counts"] = {{"most", wearer.counts.max_count},
                    {"whole_range", wearer.counts.self_calibrated}};
  line["hand_length_m"] = wearer.size.length_m;
  line["hand_breadth_m"] = wearer.size.breadth_m;
  if (!wearer.size.shape.is_average()) {
    auto& shape = line["hand_shape"];
    for (std::size_t k = 0; k < hand::shape_terms; ++k)
      shape[std::string(hand::shape_term_names[k])] = wearer.size.shape.terms[k];
  }
  line["left_out"] = gloves::sensors_json(wearer.left_out);
  line["middle_bias"] = wearer.calibration.middle_bias;
  ordered_json coupling_gains = ordered_json::array();
  for (std::size_t k = 0; k < hand::couplings.size(); ++k) {
    const auto [of, by] = hand::couplings[k];
    const double rad_per_rad = wearer.calibration.coupling_gains[k];
    if (rad_per_rad == 0.0) continue;
    coupling_gains.push_back(
        {{"of", name_of(of)}, {"by", name_of(by)}, {"rad_per_rad", rad_per_rad}});
  }
  line["mixed_in"] = std::move(coupling_gains);
  line["sensors"] = sensors_json(wearer);
  cli::print_line(line);
  return {};
}

// Returns six angles of a sensor in degrees: that of a, that of b, and how far b lies above a,
// first for a count of 0 and then for the largest count.
std::vector<double> changes_deg(const WearerCalibration& a, const WearerCalibration& b,
                                std::size_t slot) {
  std::vector<double> deg;
  for (const bool full : {false, true}) {
    for (const auto* wearer : {&a, &b}) {
      const auto& line = wearer->calibration.sensors[slot];
      const double count = full ? wearer->counts.max_count : 0.0;
      deg.push_back(to_degrees(line.gain_rad_per_count * (count - line.offset_counts)));
    }
    deg.push_back(deg.back() - deg[deg.size() - 2]);
  }
  return deg;
}

ordered_json change_json(const std::string& sensor, const std::vector<double>& deg) {
  return {{"sensor", sensor},
          {"a_at_0_deg", deg[0]},
          {"b_at_0_deg", deg[1]},
          {"change_at_0_deg", deg[2]},
          {"a_at_full_deg", deg[3]},
          {"b_at_full_deg", deg[4]},
          {"change_at_full_deg", deg[5]}};
}

Result<void> diff(const Options& options) {
  const auto a = sculpting::named_calibration(options.name, cli::note);
  if (!a) return a.error();
  const auto b = sculpting::named_calibration(options.other, cli::note);
  if (!b) return b.error();
  if (a->wearer.side != b->wearer.side)
    cli::note("A and B are for different hands, the left and the right");
  std::vector<std::vector<std::string>> rows{
      {"sensor", "a at 0", "b at 0", "change", "a at full", "b at full", "change"}};
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    if (a->wearer.calibration.sensors[slot].gain_rad_per_count == 0.0 &&
        b->wearer.calibration.sensors[slot].gain_rad_per_count == 0.0)
      continue;
    const std::string name(sensor_names[slot]);
    const auto deg = changes_deg(a->wearer, b->wearer, slot);
    if (options.json) {
      cli::print_line(change_json(name, deg));
      continue;
    }
    rows.push_back({name});
    for (const double angle_deg : deg)
      rows.back().push_back(cli::fixed(angle_deg, 1));
  }
  if (!options.json) print_table(rows);
  return {};
}

Result<void> path(const Options& options) {
  if (options.name.empty()) {
    std::cout << hand::calibration_folders().own.string() << '\n';
    return {};
  }
  const auto file = sculpting::named_calibration(options.name, cli::note);
  if (!file) return file.error();
  std::cout << file->path.string() << '\n';
  return {};
}

Result<void> remove(const Options& options) {
  const auto file = sculpting::named_calibration(options.name, cli::note);
  if (!file) return file.error();
  const auto kept = hand::retire_calibration(file->path);
  if (!kept) return kept.error();
  std::cout << "removed " << printable(file->path.string()) << "; it is kept as "
            << printable(kept->string()) << '\n';
  return {};
}

} // namespace
} // namespace nendo::app::calibration_command

void nendo::app::add_calibration(cli::Command& program) {
  using namespace calibration_command;
  auto options = std::make_shared<Options>();
  cli::Command command =
      program.add_command("calibration", "Lists, shows, compares and exchanges calibrations");
  command.set_footer("A NAME is a path, a stored file's name without .toml, or a wearer.");
  command.require_command();

  const auto add = [&](const char* name, const char* summary, Result<void> (*run)(const Options&)) {
    cli::Command added = command.add_command(name, summary);
    added.on_chosen([options, run] { return run(*options); });
    return added;
  };
  const char* const named = "Path, stored name or wearer";
  add("list", "Lists the stored calibrations, and whether each is in use", list)
      .add_flag("--json", options->json, "One JSON object per line");
  cli::Command showing = add("show", "Shows one calibration, sensor by sensor", show);
  showing.add_option("NAME", options->name, named).required();
  showing.add_flag("--json", options->json, "One JSON object");
  cli::Command comparing = add("diff", "Compares the angles of two calibrations, in degrees", diff);
  comparing.add_option("A", options->name, named).required();
  comparing.add_option("B", options->other, named).required();
  comparing.add_flag("--json", options->json, "One JSON object per sensor");
  add_calibration_exchange(command);
  add("path", "Prints the path of a calibration, or the folder of yours", path)
      .add_option("NAME", options->name, "Stored name or wearer");
  add("remove", "Removes a calibration, and keeps a copy", remove)
      .add_option("NAME", options->name, named)
      .required();
}
