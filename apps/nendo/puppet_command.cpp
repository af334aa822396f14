// nendo puppet: shows, checks and makes puppet files.

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <spdlog/fmt/fmt.h>

#include <nendo/base/files.hpp>
#include <nendo/base/text.hpp>
#include <nendo/base/units.hpp>
#include <nendo/puppet/make_puppet.hpp>
#include <nendo/puppet/rig_check.hpp>

#include "cli/cli.hpp"
#include "cli/figures.hpp"
#include "cli/output_place.hpp"
#include "cli/print.hpp"
#include "nendo/commands.hpp"
#include "nendo/model_output.hpp"
#include "render/picture.hpp"
#include "takes/model_files.hpp"

namespace nendo::app::puppet_command {
namespace {

using deform::Points;
using puppet::Function;

struct Options {
  std::string file;
  std::string up; ///< the axis that is up in the model's file; empty: y
  std::string picture;
  std::string out;
  bool force = false;
  std::string view = "15,5";
  std::string size = "360x420";
};

/// A puppet's file, its model, and the shapes that it makes of it.
struct OpenRig {
  PuppetFile file;
  deform::Mesh model;
  std::unique_ptr<puppet::RigShapes> shapes;

  const puppet::Rig& rig() const noexcept { return shapes->rig(); }
  const std::vector<Function>& functions() const noexcept { return rig().puppet().functions; }
};

Result<OpenRig> open_rig(const std::string& name, const std::string& up) {
  auto file = open_puppet(name);
  if (!file) return file.error();
  auto model = takes::read_model(file->model, takes::reading(up));
  if (!model) return model.error();
  if (const auto fits = puppet::check_fits(file->puppet, model->mesh); !fits) return fits.error();
  puppet::count_from(model->mesh.offset, file->puppet);
  OpenRig open{*std::move(file), std::move(model->mesh), nullptr};
  auto shapes = puppet::RigShapes::make(
      std::make_shared<const puppet::Rig>(open.file.puppet, open.model), open.model);
  if (!shapes) return Error{shapes.error().code, open.file.path + ": " + shapes.error().message};
  open.shapes = *std::move(shapes);
  return open;
}

std::string vector_text(const Eigen::Vector3d& vector) {
  return fmt::format("{:9.4g} {:9.4g} {:9.4g}", vector.x(), vector.y(), vector.z());
}

/// Returns the position in the file's coordinates, which need more digits far from zero.
std::string place_text(const Eigen::Vector3d& place, const Eigen::Vector3d& offset) {
  if (offset.isZero(0.0)) return vector_text(place);
  const Eigen::Vector3d in_file = place + offset;
  return fmt::format("{:9.10g} {:9.10g} {:9.10g}", in_file.x(), in_file.y(), in_file.z());
}

std::string travel_text(const Function& function) {
  if (function.input.is_angle()) return fmt::format("{:g} degrees", to_degrees(function.travel));
  return fmt::format("{:g} m", function.travel);
}

void print_function(const OpenRig& open, std::size_t at) {
  const Function& function = open.functions()[at];
  cli::print("{}: {}, {} for 1; values {:g} to {:g}{}\n", function.name, function.input.name(),
             travel_text(function), function.least, function.most, function.eases ? ", eased" : "");
  const Points& vectors = open.rig().vectors_of(at);
  for (std::size_t point = 0; point < open.rig().puppet().points.size(); ++point) {
    const Eigen::Vector3d vector = vectors.col(static_cast<Eigen::Index>(point));
    if (vector.isZero(0.0)) continue;
    cli::print("  {:<20} by {}  ({:.4g})\n", open.rig().puppet().points[point].name,
               vector_text(vector), vector.norm());
  }
}

/// Returns the radii as --radius takes them.
std::string radii_text(const puppet::PuppetPoint& point) {
  std::string text;
  for (const deform::Support& support : point.supports()) {
    text += fmt::format("{}{:.4g}", text.empty() ? "" : "+", support.radius);
    if (support.weight != 1.0) text += fmt::format(":{:.4g}", support.weight);
  }
  return text;
}

void print_points(const OpenRig& open) {
  cli::print("points\n");
  for (std::size_t at = 0; at < open.rig().puppet().points.size(); ++at) {
    const puppet::PuppetPoint& point = open.rig().puppet().points[at];
    cli::print(
        "  {:<20} at {}  radius {}{}\n", point.name,
        place_text(open.rig().starts().col(static_cast<Eigen::Index>(at)), open.model.offset),
        radii_text(point), point.is_pin ? ", pin" : "");
  }
}

void print_head(const OpenRig& open) {
  const auto& puppet = open.rig().puppet();
  cli::print("{} on {}: {} vertices, {}, {}, distances {}\n", printable(open.file.path),
             printable(puppet.model), open.model.vertices.cols(),
             cli::count_text(puppet.points.size(), "point"),
             cli::count_text(puppet.functions.size(), "function"),
             puppet.distance == puppet::Distance::surface ? "along the surface"
                                                          : "through the air");
}

std::string gesture_text(const puppet::ClutchOptions& clutch, puppet::ClutchTrigger means) {
  switch (means) {
  case puppet::ClutchTrigger::fist:
    return fmt::format("a fist (fingers bent by {:.0f} degrees, held for {:g} s)", clutch.fist_deg,
                       clutch.held_s);
  case puppet::ClutchTrigger::pinch:
    return fmt::format("a pinch (tips within {:g} m, held for {:g} s)", clutch.pinch_m,
                       clutch.held_s);
  case puppet::ClutchTrigger::wrist_switch:
    return "the wrist switch";
  case puppet::ClutchTrigger::none:
    break;
  }
  return {};
}

void print_clutches(const OpenRig& open) {
  const puppet::ClutchOptions& clutch = open.rig().puppet().clutch;
  for (const Side side : {Side::left, Side::right}) {
    const std::string words = gesture_text(clutch, clutch.means[static_cast<std::size_t>(side)]);
    if (!words.empty())
      cli::print("the {} hand releases and grabs again by {}\n", name_of(side), words);
  }
}

/// The shapes of a sheet, the model at rest first.
struct Sheet {
  std::vector<Points> shapes;
  std::vector<std::string> captions;

  void add(Points shape, std::string caption) {
    shapes.push_back(std::move(shape));
    captions.push_back(std::move(caption));
  }
};

Sheet sheet_of(OpenRig& open) {
  Sheet sheet;
  sheet.add(open.model.vertices, "rest");
  for (std::size_t at = 0; at < open.functions().size(); ++at) {
    const Function& function = open.functions()[at];
    const bool has_both = function.least < 0.0 && function.most > 0.0;
    for (const double value : {function.most, function.least})
      if (value != 0.0)
        sheet.add(open.shapes->at(at, value),
                  has_both ? fmt::format("{} {:g}", function.name, value) : function.name);
  }
  return sheet;
}

/// Returns the vertices that functions move by more than rounding errors. The camera frames only
/// these, for example the face of a bust.
std::vector<Eigen::Index> moving_vertices(const std::vector<Points>& shapes) {
  const Points& rest = shapes.front();
  const double least = 1e-3 * deform::diagonal_of(rest);
  std::vector<Eigen::Index> moving;
  for (Eigen::Index vertex = 0; vertex < rest.cols(); ++vertex)
    if (std::any_of(shapes.begin(), shapes.end(), [&](const Points& shape) {
          return (shape.col(vertex) - rest.col(vertex)).norm() > least;
        }))
      moving.push_back(vertex);
  return moving;
}

Result<void> draw_sheet(const Sheet& sheet, const deform::Mesh& model, const Options& options,
                        render::View view, render::Size size) {
  const render::SceneBuilder builder(model);
  std::vector<render::Scene> scenes(sheet.shapes.size());
  const std::vector<Eigen::Index> moving = moving_vertices(sheet.shapes);
  std::vector<Eigen::Vector3f> outline;
  for (std::size_t at = 0; at < scenes.size(); ++at) {
    render::SceneFrame frame;
    frame.vertices = sheet.shapes[at];
    builder.build(frame, {}, scenes[at]);
    for (const Eigen::Index vertex : moving)
      outline.push_back(
          (sheet.shapes[at].col(vertex) / builder.units_per_metre() - builder.origin_m())
              .cast<float>());
  }
  const render::Camera camera = render::framing(outline, view, 1.0 * size.width / size.height);
  std::vector<render::Panel> panels;
  for (std::size_t at = 0; at < scenes.size(); ++at)
    panels.push_back(
        {draw(render::Lighting(scenes[at], view.azimuth_deg), camera, size), sheet.captions[at]});
  return write_png(options.picture, contact_sheet(panels));
}

Result<void> show(const Options& options) {
  const auto view = render::view_named(options.view);
  if (!view)
    return Error{Errc::usage, "--camera " + options.view +
                                  ": use front, back, left, right, side, top or "
                                  "AZIMUTH,ELEVATION in degrees"};
  const auto size = render::size_named(options.size);
  if (!size || 1.0 * size->width * size->height > 1e6)
    return Error{Errc::usage, "--pixels " + options.size +
                                  ": use WIDTHxHEIGHT in pixels, 16 or more each, at most a "
                                  "million together"};
  if (auto fine = cli::check_place("--picture", options.picture, {".png"}); !fine) return fine;
  auto open = open_rig(options.file, options.up);
  if (!open) return open.error();
  print_head(*open);
  for (std::size_t at = 0; at < open->functions().size(); ++at)
    print_function(*open, at);
  print_points(*open);
  print_clutches(*open);
  if (options.picture.empty()) return {};
  if (auto drawn = draw_sheet(sheet_of(*open), open->model, options, *view, *size); !drawn)
    return drawn;
  report_written(options.picture);
  return {};
}

std::string limit_text(const OpenRig& open, const puppet::AtLimit& limit) {
  return fmt::format("{} at {:g}", open.functions()[limit.function].name, limit.value);
}

std::string turned_text(const puppet::LimitCheck& limit) {
  const double part = limit.moved == 0 ? 0.0
                                       : 100.0 * static_cast<double>(limit.turned) /
                                             static_cast<double>(limit.moved);
  return fmt::format("{} of {} that move are reversed ({:.2g} %)", limit.turned,
                     cli::count_text(limit.moved, "triangle"), part);
}

void print_turned(const OpenRig& open, const puppet::RigCheck& check) {
  for (const puppet::LimitCheck& limit : check.alone)
    if (limit.turned > 0 || limit.moved == 0)
      cli::print("{}: {}{}\n", limit_text(open, limit.one), turned_text(limit),
                 puppet::RigCheck::folds(limit) ? "; too many" : "");
  const puppet::LimitCheck* worst = nullptr;
  std::size_t pairs = 0;
  for (const puppet::LimitCheck& pair : check.pairs) {
    if (pair.turned == 0) continue;
    ++pairs;
    if (worst == nullptr || pair.turned > worst->turned) worst = &pair;
  }
  cli::print("{} of {} reverse triangles", pairs, cli::count_text(check.pairs.size(), "pair"));
  if (worst != nullptr)
    cli::print("; the worst is {} with {}: {}", limit_text(open, worst->one),
               limit_text(open, *worst->other), turned_text(*worst));
  cli::print("\n");
}

void print_twins(const OpenRig& open, const puppet::RigCheck& check) {
  if (check.twins.empty()) return;
  if (check.lone_vertices > 0)
    cli::print("the model itself is not symmetric: {} of {} vertices have no mirror image\n",
               check.lone_vertices, open.model.vertices.cols());
  if (check.lone_vertices == static_cast<std::size_t>(open.model.vertices.cols())) return;
  double apart = 0.0;
  for (const puppet::TwinCheck& twins : check.twins) {
    apart = std::max(apart, twins.apart);
    if (!check.are_symmetric(twins))
      cli::print("{} and {} are not symmetric: {:.2g} of the diagonal apart\n",
                 open.functions()[twins.left].name, open.functions()[twins.right].name,
                 twins.apart);
  }
  if (std::all_of(check.twins.begin(), check.twins.end(),
                  [&](const auto& twins) { return check.are_symmetric(twins); }))
    cli::print("{} are symmetric within {:.2g} of the diagonal, and the model within {:.2g}\n",
               cli::count_text(check.twins.size(), "pair") + " of twins", apart, check.model_apart);
}

Result<void> check(const Options& options) {
  auto open = open_rig(options.file, options.up);
  if (!open) return open.error();
  print_head(*open);
  if (open->shapes->condition() > 0.0)
    cli::print("condition {:.3g}, of at most {:g}\n", open->shapes->condition(),
               deform::SurfaceField::max_condition);
  const auto check = puppet::check_rig(*open->shapes, open->model);
  print_turned(*open, check);
  print_twins(*open, check);
  for (const puppet::LimitCheck& limit : check.alone)
    if (puppet::RigCheck::folds(limit))
      return Error{Errc::failed,
                   fmt::format("{}: {}: {}; move its points less, or make their radii larger",
                               open->file.path, limit_text(*open, limit.one), turned_text(limit))};
  return {};
}

Result<void> make(const Options& options) {
  if (auto fine = cli::check_place("--out", options.out, {".toml"}); !fine) return fine;
  std::error_code ignored;
  if (!options.force && std::filesystem::exists(options.out, ignored))
    return Error{Errc::usage, "--out " + options.out + ": exists; --force replaces it"};
  const auto name = cli::name_beside(options.file, options.out);
  if (!name) return name.error();
  const auto model = takes::read_model(options.file, takes::reading(options.up));
  if (!model) return model.error();
  const auto made = puppet::make_face_puppet(model->mesh, *name);
  if (!made) return Error{made.error().code, options.file + ": " + made.error().message};
  for (const std::string& line : made->found)
    cli::print("{}\n", line);
  if (options.up == "z")
    cli::note(options.out + ": play it with --up z, because z is up in its model");
  std::string text = made->text;
  if (!model->mesh.offset.isZero(0.0)) {
    auto puppet = puppet::parse_puppet(text, options.out);
    if (!puppet) return puppet.error();
    puppet::count_from(-model->mesh.offset, *puppet);
    text = puppet->text;
  }
  if (auto written = replace_file(options.out, text); !written) return written;
  report_written(options.out);
  return {};
}

} // namespace
} // namespace nendo::app::puppet_command

void nendo::app::add_puppet(cli::Command& program) {
  using namespace puppet_command;
  auto options = std::make_shared<Options>();
  cli::Command command = program.add_command(
      "puppet", "Shows, checks and makes puppets: what each finger does to a model");
  command.set_footer("A FILE is a path, or the name of a shipped puppet, such as face.");
  command.require_command();

  const auto add = [&](const char* name, const char* summary, const char* argument,
                       const char* argument_summary, Result<void> (*run)(const Options&)) {
    cli::Command added = command.add_command(name, summary);
    added.add_option(argument, options->file, argument_summary).required();
    takes::add_up_option(added, options->up);
    added.on_chosen([options, run] { return run(*options); });
    return added;
  };
  const char* const puppet = "Puppet file, or the name of a shipped one";
  cli::Command showing = add("show", "Shows a puppet's functions and points", "FILE", puppet, show);
  showing.add_option("--picture", options->picture,
                     "Where to draw the model at rest and each function at its limits, .png");
  showing.add_option("--camera", options->view,
                     "front, back, left, right, side, top, or AZIMUTH,ELEVATION in degrees");
  showing.add_option("--pixels", options->size, "WIDTHxHEIGHT in pixels, of each picture");
  add("check", "Checks for reversed triangles at the functions' limits, and for symmetry", "FILE",
      puppet, check);
  cli::Command making = add("make", "Makes a puppet for a face from the shape of the model",
                            "MODEL", "OBJ, PLY, STL or glTF file", make);
  making.set_footer("The face must look along +z, with y up (--up z lays a model with z up), and "
                    "be symmetric about x = 0.");
  making.add_option("--out", options->out, "Where to write the puppet, .toml, beside the model")
      .required();
  making.add_flag("--force", options->force, cli::force_summary);
}
