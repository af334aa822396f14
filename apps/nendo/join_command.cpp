// nendo join: parts that overlap become one.

#include <cmath>
#include <iostream>
#include <string>
#include <vector>

#include <spdlog/fmt/fmt.h>

#include <nendo/base/text.hpp>
#include <nendo/deform/cut.hpp>
#include <nendo/deform/join.hpp>

#include "cli/cli.hpp"
#include "cli/print.hpp"
#include "nendo/commands.hpp"
#include "nendo/model_output.hpp"

namespace nendo::app::join_command {
namespace {

using namespace nendo::deform;

struct Options {
  std::vector<std::string> parts;
  double seam = 0.0;
  ModelOutput output;
};

Result<void> check(const Options& options) {
  if (!(options.seam >= 0.0) || !std::isfinite(options.seam))
    return Error{Errc::usage, "--seam: use a width in the models' units, 0 or more"};
  return options.output.check(options.output.out, options.parts);
}

struct NamedMesh {
  Mesh mesh;
  std::string name; ///< the name in messages
};

/// Returns the models of several files, or the parts of one.
Result<std::vector<NamedMesh>> read_parts(const Options& options) {
  const std::vector<std::string>& files = options.parts;
  std::vector<NamedMesh> parts;
  for (const std::string& file : files) {
    auto model = options.output.read(file);
    if (!model) return model.error();
    parts.push_back({*std::move(model), file});
  }
  if (parts.size() > 1) return parts;
  std::vector<Mesh> separated = separate(parts.front().mesh);
  if (separated.size() < 2)
    return Error{Errc::usage, files.front() + ": has only one part; name a second file, or a file "
                                              "with several parts"};
  parts.clear();
  for (Mesh& part : separated)
    parts.push_back(
        {std::move(part), files.front() + ", part " + std::to_string(parts.size() + 1)});
  return parts;
}

void report_step(const std::string& name, const Options& options, const JoinStep& step) {
  if (step.swallowed) {
    cli::note(name + ": does not cross the parts before it; one lies inside the other, and the "
                     "inner one was removed");
    return;
  }
  cli::print("{}: {} crossings, volume {:.6g}", printable(name), step.crossings, step.volume);
  if (step.seam_width > 0.0) cli::print(" ({:.6g} if sharp)", step.sharp_volume);
  std::cout << '\n';
  if (step.seam_width < options.seam)
    cli::note(
        fmt::format("--seam {:.6g}: too wide: the surface would cross itself, so the seam is ",
                    options.seam) +
        (step.seam_width > 0.0 ? fmt::format("{:.6g} wide", step.seam_width) : "sharp"));
}

Result<void> join_files(const Options& options) {
  if (auto fine = check(options); !fine) return fine;
  const auto named = read_parts(options);
  if (!named) return named.error();
  std::vector<JoinPart> parts;
  for (const NamedMesh& part : *named)
    parts.push_back({&part.mesh, part.name});
  const auto joined = join(parts, {.seam_width = options.seam});
  if (!joined) return joined.error();
  for (std::size_t at = 0; at < joined->steps.size(); ++at)
    report_step((*named)[at + 1].name, options, joined->steps[at]);
  if (auto done = options.output.write(options.output.out, joined->mesh); !done) return done;
  report_model(options.output.out, joined->mesh, volume_text(joined->mesh));
  return {};
}

} // namespace
} // namespace nendo::app::join_command

void nendo::app::add_join(cli::Command& program) {
  using namespace join_command;
  cli::Command command = program.add_command("join", "Joins models that overlap into one, exactly");
  Options& options = command.on_chosen<Options>(join_files);
  command
      .add_option("PART", options.parts,
                  "OBJ, PLY, STL or glTF files of closed models; of one file, its parts are joined")
      .required();
  command.add_option("--seam", options.seam,
                     "Width of the blend on each side of the seam, in the models' units; 0 leaves "
                     "the seam sharp");
  options.output.add_to(command, "Where to write the result, .obj, .ply or .stl");
}
