// nendo deform: deforms a model by control vectors of a file.

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <spdlog/fmt/fmt.h>

#include <nendo/deform/control_vectors.hpp>
#include <nendo/deform/csrbf.hpp>
#include <nendo/deform/injective_chain.hpp>
#include <nendo/deform/midpoint_chain.hpp>
#include <nendo/flow/setting.hpp>

#include "cli/cli.hpp"
#include "cli/figures.hpp"
#include "cli/print.hpp"
#include "nendo/commands.hpp"
#include "nendo/model_output.hpp"
#include "session/setting_options.hpp"

namespace nendo::app::deform_command {
namespace {

using namespace nendo::deform;

struct Options {
  std::string mesh;
  std::string vectors;
  ModelOutput output;
  std::string radius;
  std::string common_radius;
  session::SettingArguments settings;
  std::string polynomial = "none";
};

Result<std::optional<Support>> common_radius(const Options& options, bool is_used) {
  if (options.common_radius.empty()) return std::optional<Support>();
  const auto common = parse_supports(options.common_radius);
  if (!common || common->size() != 1) {
    return Error{Errc::usage, "--common-radius " + options.common_radius +
                                  ": use R or R:WEIGHT, both greater than 0"};
  }
  if (!is_used) {
    return Error{Errc::usage, "--common-radius: needs a radius column, and " + options.vectors +
                                  " has none; leave it out"};
  }
  return std::optional(common->front());
}

Result<Supports> supports_for(const ControlVectors& vectors, const Options& options) {
  const bool has_own = !vectors.own.empty();
  const auto common = common_radius(options, has_own);
  if (!common) return common.error();
  if (has_own) return with_common(vectors.own, *common);
  if (options.radius.empty()) {
    return Error{Errc::usage,
                 "--radius is missing: " + options.vectors +
                     " has no radius column; give --radius R in the mesh's units, R > 0"};
  }
  auto shared = parse_supports(options.radius);
  if (!shared) {
    return Error{Errc::usage,
                 "--radius " + options.radius +
                     ": use a number > 0, in the mesh's units (there is no stage for lengths "
                     "like 3cm), or several with weights, like 10+40:0.5"};
  }
  return Supports{std::move(*shared), {}};
}

Result<FieldStatus> deform_at_once(Points& vertices, const ControlVectors& vectors,
                                   const Supports& supports, const CsrbfOptions& csrbf,
                                   const Options& options) {
  CsrbfSolver solver(csrbf);
  CsrbfField field;
  FieldStatus status = solver.build(vectors.starts, supports);
  if (is_solved(status)) status = std::max(status, solver.solve(vectors.displacements, field));
  if (!is_solved(status))
    return Error{Errc::bad_input, options.vectors + ": " + std::string(describe(status))};
  displace(field, vertices, vertices);
  return status;
}

/// The number for displacements of 12 radii; longer ones take longer steps.
constexpr int max_volume_steps = 256;

Result<FieldStatus> deform_keeping_volume(Points& vertices, const ControlVectors& vectors,
                                          const Supports& supports, const CsrbfOptions& csrbf,
                                          const Options& options) {
  MidpointChain chain(vectors.starts.cols(), supports, csrbf, max_volume_steps);
  FieldStatus status = chain.grab(vectors.starts);
  if (is_solved(status)) status = std::max(status, chain.go(vectors.displacements));
  std::vector<CsrbfField> step;
  while (is_solved(status) && chain.next()) {
    step.push_back(chain.field());
    if (step.back().is_halfway) continue;
    displace(step, vertices, vertices);
    step.clear();
  }
  status = std::max(status, chain.status());
  if (is_solved(status)) return status;
  const bool many = vectors.starts.cols() > CsrbfSolver::max_volume_points;
  return Error{Errc::bad_input,
               options.vectors + ": " +
                   (many ? "--keep-volume takes at most " +
                               std::to_string(CsrbfSolver::max_volume_points) + " control vectors"
                         : std::string(describe(status)))};
}

/// Ordinary strokes need ten; thousands mean displacements of thousands of radii.
constexpr int max_links = 2000;

/// Prints one line: links, bound, min determinant at the vertices, and the pairs held apart.
void print_report(const InjectiveChain& chain, double min_determinant) {
  const ChainReport& report = chain.report();
  const std::string whole =
      report.links > 1 ? fmt::format(" ({:.3g} in one step)", report.whole_bound) : std::string();
  std::vector<std::string> pairs;
  for (const HeldPair& wall : chain.walls())
    if (wall.push > 0.0) pairs.push_back(fmt::format("{}-{}", wall.first + 1, wall.second + 1));
  cli::print("injective: {}, bound {:.3g}{}, min determinant {:.3g}, {} held apart{}{}\n",
             cli::count_text(static_cast<std::size_t>(report.links), "link"), report.bound, whole,
             min_determinant, cli::count_text(static_cast<std::size_t>(report.held_pairs), "pair"),
             pairs.empty() ? "" : ": ", cli::joined(pairs));
}

Result<FieldStatus> deform_in_links(Points& vertices, const ControlVectors& vectors,
                                    const Supports& supports, const CsrbfOptions& csrbf,
                                    const Options& options) {
  const auto bad = [&](const std::string& what) {
    return Error{Errc::bad_input, options.vectors + ": " + what};
  };
  InjectiveChain chain(vectors.starts.cols(), supports, csrbf, {.max_links = max_links});
  FieldStatus status = chain.grab(vectors.starts);
  if (is_solved(status)) {
    const FieldStatus asked = chain.from_start(vectors.starts + vectors.displacements);
    status = std::max(status, asked);
  }
  DeterminantProbe probe;
  probe.start(vertices);
  while (is_solved(status) && chain.next()) {
    probe.advance(chain.field());
    displace(chain.field(), vertices, vertices);
  }
  status = std::max(status, chain.report().status);
  if (!is_solved(status)) return bad(std::string(describe(status)));
  if (!chain.report().reached)
    return bad("--injective needs more than " + std::to_string(max_links) +
               " links; make the displacements shorter");
  print_report(chain, std::min(probe.min_determinant(), chain.report().min_determinant));
  return status;
}

Result<void> deform_file(const Options& options) {
  const auto settings = options.settings.parse();
  if (!settings) return settings.error();
  const auto csrbf = session::csrbf_for(*settings, options.polynomial);
  if (!csrbf) return csrbf.error();
  constexpr auto nothing = flow::Played::nothing;
  if (auto fine = flow::all_effective(*settings, nothing, flow::Naming::options); !fine)
    return fine;
  if (auto fine = options.output.check(options.output.out, std::array{options.mesh}); !fine)
    return fine;
  auto read = options.output.read(options.mesh);
  if (!read) return read.error();
  Mesh& mesh = *read;
  auto vectors = read_control_vectors(options.vectors);
  if (!vectors) return vectors.error();
  vectors->starts.colwise() -= mesh.offset;
  if (!vectors->columns_not_read.empty())
    cli::note(options.vectors + ": not read: " + vectors->columns_not_read);
  const auto supports = supports_for(*vectors, options);
  if (!supports) return supports.error();
  warn_about_reach(vectors->own.empty() ? "--radius " + options.radius : options.vectors,
                   box_of_faces(mesh), vectors->starts, *supports);

  const Points before = mesh.vertices;
  const auto by = csrbf->keeps_volume() ? deform_keeping_volume
                  : settings->injective ? deform_in_links
                                        : deform_at_once;
  const auto status = by(mesh.vertices, *vectors, *supports, *csrbf, options);
  if (!status) return status.error();
  if (*status == FieldStatus::merged) {
    cli::note(options.vectors +
              ": some start points coincide; they share the mean of their displacements");
  }
  if (!mesh.vertices.allFinite()) {
    return Error{Errc::bad_input,
                 options.vectors + ": " + std::string(describe(FieldStatus::not_finite))};
  }
  if (mesh.vertices == before)
    cli::note(options.vectors +
              ": moves no vertex; all displacements are 0, or no vertex is within "
              "the radius of a start point");
  if (auto done = options.output.write(options.output.out, mesh); !done) return done;
  report_model(options.output.out, mesh);
  return {};
}

} // namespace
} // namespace nendo::app::deform_command

void nendo::app::add_deform(cli::Command& program) {
  using namespace deform_command;
  cli::Command command =
      program.add_command("deform", "Deforms a mesh by control vectors of a file");
  Options& options = command.on_chosen<Options>(deform_file);
  command.add_option("MESH", options.mesh, "OBJ, PLY, STL or glTF file").required();
  command
      .add_option("--vectors", options.vectors,
                  "CSV file: x,y,z,dx,dy,dz[,radius], one control vector per line")
      .required();
  command.add_option("--radius", options.radius,
                     "Radius of the supports, in the mesh's units, or several with weights for a "
                     "kernel that is their sum: 10+40:0.5; a radius column takes precedence");
  command.add_option(
      "--common-radius", options.common_radius,
      "Radius that all control vectors share, in addition to those of a radius column, so "
      "that there is always a solution; without it, the smallest of them with weight 0.01");
  options.settings.add(command, flow::setting::kernel);
  session::add_polynomial_option(command, options.polynomial);
  options.settings.add(command, flow::setting::keep_volume);
  options.settings.add(command, flow::setting::injective);
  options.output.add_to(command, "Where to write the result, .obj, .ply or .stl");
}
