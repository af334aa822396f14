// nendo cut: cuts models apart by a plane or a wire.

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <spdlog/fmt/fmt.h>

#include <nendo/base/advised_command.hpp>
#include <nendo/base/files.hpp>
#include <nendo/base/table.hpp>
#include <nendo/base/text.hpp>
#include <nendo/deform/closed_manifold.hpp>
#include <nendo/deform/cut.hpp>
#include <nendo/deform/mesh.hpp>
#include <nendo/deform/offset.hpp>
#include <nendo/deform/repair.hpp>

#include "cli/cli.hpp"
#include "nendo/commands.hpp"
#include "nendo/model_output.hpp"

namespace nendo::app::cut_command {
namespace {

using namespace nendo::deform;

struct Options {
  std::vector<std::string> models;
  std::string plane;
  std::string wire;
  ModelOutput output;
  std::optional<double> edge;
  bool repair = false;
};

using AnyBlade = std::variant<CutPlane, CutWire>;

/// Reads six finite numbers with commas or blanks between them.
std::optional<std::array<double, 6>> six_numbers(std::string_view text) {
  std::string blanks(text);
  for (char& letter : blanks)
    if (letter == ',') letter = ' ';
  const auto fields = fields_of(blanks, 7);
  std::array<double, 6> numbers{};
  if (fields.size() != numbers.size()) return std::nullopt;
  for (std::size_t at = 0; at < numbers.size(); ++at) {
    const auto number = to_finite_number(fields[at]);
    if (!number) return std::nullopt;
    numbers[at] = *number;
  }
  return numbers;
}

Result<AnyBlade> plane_of(const std::string& text) {
  const auto numbers = six_numbers(text);
  if (!numbers || ((*numbers)[3] == 0.0 && (*numbers)[4] == 0.0 && (*numbers)[5] == 0.0))
    return Error{Errc::usage,
                 "--plane " + text + ": use X,Y,Z,NX,NY,NZ, a point and a normal that is not zero"};
  return AnyBlade(CutPlane{Eigen::Vector3d((*numbers)[0], (*numbers)[1], (*numbers)[2]),
                           Eigen::Vector3d((*numbers)[3], (*numbers)[4], (*numbers)[5])});
}

constexpr std::size_t largest_wire_file = std::size_t{16} << 20;

Result<AnyBlade> wire_of(const std::string& file) {
  const auto text = read_file(file, largest_wire_file, "wire");
  if (!text) return text.error();
  CutWire wire;
  TableReader table(*text, file);
  if (const auto fine = table.begin_without_head(6); !fine) return fine.error();
  for (;;) {
    const auto any = table.next();
    if (!any) return any.error();
    if (!*any) break;
    std::array<double, 6> numbers{};
    for (std::size_t at = 0; at < numbers.size(); ++at) {
      const auto number = table.number(at);
      if (!number)
        return table.bad_cell(at, "is not a finite number; a row has six, the wire's two ends: "
                                  "X,Y,Z,X,Y,Z");
      numbers[at] = *number;
    }
    wire.places.push_back({Eigen::Vector3d(numbers[0], numbers[1], numbers[2]),
                           Eigen::Vector3d(numbers[3], numbers[4], numbers[5])});
  }
  if (wire.places.size() < 2)
    return Error{Errc::bad_input, file + ": has fewer than two positions of the wire"};
  return AnyBlade(std::move(wire));
}

/// The name of a part: %d becomes its number, from 1, and %s the model's name without its ending.
std::string part_name(const std::string& pattern, const std::string& model, std::size_t number) {
  std::string name;
  for (std::size_t at = 0; at < pattern.size(); ++at) {
    const char kind = pattern[at] == '%' && at + 1 < pattern.size() ? pattern[at + 1] : '\0';
    if (kind != 'd' && kind != 's') {
      name += pattern[at];
      continue;
    }
    name += kind == 'd' ? std::to_string(number) : std::filesystem::path(model).stem().string();
    ++at;
  }
  return name;
}

Result<void> check(const Options& options) {
  const auto has = [&](std::string_view what) {
    return options.output.out.find(what) != std::string::npos;
  };
  if (options.plane.empty() == options.wire.empty())
    return Error{Errc::usage, "--plane and --wire: give one of them"};
  if (options.models.size() > 1 && !has("%s"))
    return Error{Errc::usage, "--out " + options.output.out +
                                  ": with several models, use a name with %s, which becomes the "
                                  "model's name"};
  if (options.edge && !(*options.edge > 0.0))
    return Error{Errc::usage, "--edge: use a length greater than 0, in the models' units"};
  return options.output.check(part_name(options.output.out, options.models.front(), 1), {});
}

Result<Mesh> closed_model(const std::string& file, const Options& options) {
  auto mesh = options.output.read(file);
  if (!mesh) return mesh;
  const ManifoldCheck closed = check_closed_manifold(*mesh);
  if (closed) {
    if (const std::size_t turned = turn_outwards(*mesh); turned > 0)
      cli::note(file + ": " + std::to_string(turned) +
                " of its faces look inwards; they are reversed before the cut, as by `nendo "
                "repair`");
    return mesh;
  }
  if (!options.repair)
    return Error{Errc::bad_input,
                 file + ": " + describe(closed, *mesh) +
                     "; only closed models can be cut, so try --repair, or `nendo repair " +
                     shell_word(file) + " --out OUT`"};
  auto repaired = deform::repair(*mesh);
  if (!repaired) return Error{repaired.error().code, file + ": " + repaired.error().message};
  for (const std::string& line : lines_of(*repaired))
    cli::note(file + ": " + line);
  return std::move(repaired->mesh);
}

/// The blade is in the file's coordinates.
Result<CutModel> cut_by(const Mesh& mesh, const AnyBlade& blade, const Options& options) {
  CutOptions cut;
  cut.edge = options.edge.value_or(0.0);
  if (const auto* plane = std::get_if<CutPlane>(&blade))
    return cut_model(mesh, CutPlane{plane->point - mesh.offset, plane->normal}, cut);
  CutWire wire = std::get<CutWire>(blade);
  for (WirePlace& place : wire.places)
    place = {place.from - mesh.offset, place.to - mesh.offset};
  return cut_model(mesh, wire, cut);
}

Result<void> write_parts(const std::string& file, const CutModel& cut, const Options& options) {
  const ModelOutput& output = options.output;
  const bool is_each_alone = output.out.find("%d") != std::string::npos;
  const std::vector<Mesh> meshes = is_each_alone ? separate(cut) : std::vector<Mesh>{cut.mesh};
  std::vector<std::string> names;
  for (std::size_t at = 0; at < meshes.size(); ++at) {
    names.push_back(part_name(output.out, file, at + 1));
    if (auto fine = output.check(names.back(), options.models); !fine) return fine;
  }
  for (std::size_t at = 0; at < meshes.size(); ++at) {
    if (auto done = output.write(names[at], meshes[at]); !done) return done;
    report_model(names[at], meshes[at],
                 volume_text(meshes[at]) +
                     (meshes.size() == 1 ? fmt::format(", in {} parts", cut.parts) : ""));
  }
  return {};
}

std::string box_text(const Mesh& mesh) {
  const Box box = box_of_faces(mesh);
  return place_text(box.lowest, mesh.offset) + " to " + place_text(box.highest, mesh.offset);
}

Result<void> cut_file(const std::string& file, const AnyBlade& blade, const Options& options) {
  const auto mesh = closed_model(file, options);
  if (!mesh) return mesh.error();
  const auto cut = cut_by(*mesh, blade, options);
  if (!cut) {
    // A blade that misses is mostly in other units, or at another place.
    const std::string where =
        cut.error().code == Errc::failed ? "; it fills " + box_text(*mesh) : "";
    return Error{cut.error().code, file + ": " + cut.error().message + where};
  }
  if (cut->uncut_loops > 0)
    cli::note(file + ": is not cut at " + std::to_string(cut->uncut_loops) +
              (cut->uncut_loops == 1 ? " place" : " places") +
              " where the wire does not pass through, or separates nothing");
  return write_parts(file, *cut, options);
}

/// Cuts one model after another, also after an error. Returns the first error's code.
int cut_files(const Options& options) {
  if (const auto fine = check(options); !fine) return cli::report(fine.error());
  const auto blade = options.wire.empty() ? plane_of(options.plane) : wire_of(options.wire);
  if (!blade) return cli::report(blade.error());
  int code = 0;
  for (const std::string& file : options.models) {
    const auto done = cut_file(file, *blade, options);
    if (done) continue;
    const int failed = cli::report(done.error());
    if (code == 0) code = failed;
  }
  return code;
}

} // namespace
} // namespace nendo::app::cut_command

void nendo::app::add_cut(cli::Command& program) {
  using namespace cut_command;
  cli::Command command = program.add_command(
      "cut", "Cuts closed models apart by a plane or a wire; the parts are closed again");
  Options& options = command.on_chosen<Options>(cut_files);
  command.add_option("MODEL", options.models, "OBJ, PLY, STL or glTF files").required();
  command.add_option("--plane", options.plane,
                     "X,Y,Z,NX,NY,NZ: a point of the plane and its normal, in the model's units");
  command.add_option("--wire", options.wire,
                     "Text file with the positions of a wire, one per line, in order: X,Y,Z,X,Y,Z "
                     "of its two ends, in the model's units; lines that begin with # are skipped");
  options.output.add_to(
      command, "Where to write the parts, .obj, .ply or .stl: %d becomes the part's number, from "
               "1, and %s the model's name; without %d all parts are written into one file");
  command.add_option("--edge", options.edge,
                     "Length of the cut faces' edges; without it, about that of the faces which "
                     "the blade crosses");
  command.add_flag("--repair", options.repair,
                   "Repair a model that is not closed before the cut, as `nendo repair` does");
}
