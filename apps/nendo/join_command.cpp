// nendo join: parts that overlap become one.

#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include <nendo/deform/cut.hpp>
#include <nendo/deform/join.hpp>
#include <nendo/deform/mesh_file.hpp>

#include "cli/cli.hpp"
#include "cli/output_place.hpp"
#include "nendo/commands.hpp"
#include "takes/model_files.hpp"

namespace nendo::app::join_command {
namespace {

using namespace nendo::deform;

struct Options {
  std::vector<std::string> parts;
  double seam = 0.0;
  std::string out;
  std::string up; ///< empty: y
  bool force = false;
};

Result<void> check(const Options& options) {
  if (!(options.seam >= 0.0) || !std::isfinite(options.seam))
    return Error{Errc::usage, "--seam: use a width in the models' units, 0 or more"};
  if (auto fine = cli::check_place("--out", options.out, deform::mesh_endings); !fine) return fine;
  for (const std::string& part : options.parts)
    if (auto fine = cli::check_spares(part, "--out", options.out, options.force); !fine)
      return fine;
  return {};
}

std::string short_number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

struct NamedMesh {
  Mesh mesh;
  std::string name; ///< for messages
};

/// Of several files, each is a part. Of one, its parts are.
Result<std::vector<NamedMesh>> read_parts(const std::vector<std::string>& files,
                                          const deform::ReadOptions& reading) {
  std::vector<NamedMesh> parts;
  for (const std::string& file : files) {
    auto model = takes::read_model(file, reading);
    if (!model) return model.error();
    parts.push_back({std::move(model->mesh), file});
  }
  if (parts.size() > 1) return parts;
  std::vector<Mesh> separated = separate(parts.front().mesh);
  if (separated.size() < 2)
    return Error{Errc::usage, files.front() + ": is one part, which is whole; name a second file, "
                                              "or a file of several parts"};
  parts.clear();
  for (Mesh& part : separated)
    parts.push_back(
        {std::move(part), files.front() + ", part " + std::to_string(parts.size() + 1)});
  return parts;
}

/// Returns what was done, and what is hardly meant.
void note_step(const std::string& name, const Options& options, const JoinStep& step) {
  if (step.swallowed) {
    cli::note(name + ": it and what was joined before do not cross, one lies inside of the other; "
                     "what is inside is gone");
    return;
  }
  std::string text = name + ": " + std::to_string(step.crossings) + " crossings, volume " +
                     short_number(step.volume);
  if (step.seam_width > 0.0) text += " (" + short_number(step.sharp_volume) + " with a sharp seam)";
  cli::note(text);
  if (step.seam_width < options.seam)
    cli::note("--seam " + short_number(options.seam) + ": the surface would cut itself there, so " +
              (step.seam_width > 0.0 ? "the seam is " + short_number(step.seam_width) + " wide"
                                     : std::string("the seam is sharp")));
}

Result<void> join_files(const Options& options) {
  if (const auto fine = check(options); !fine) return fine.error();
  const auto named = read_parts(options.parts, takes::reading(options.up));
  if (!named) return named.error();
  std::vector<JoinPart> parts;
  for (const NamedMesh& part : *named)
    parts.push_back({&part.mesh, part.name});
  const auto joined = join(parts, {.seam_width = options.seam});
  if (!joined) return joined.error();
  for (std::size_t at = 0; at < joined->steps.size(); ++at)
    note_step((*named)[at + 1].name, options, joined->steps[at]);
  return takes::write_model(options.out, joined->mesh, takes::axis_of(takes::reading(options.up)));
}

} // namespace

void add(cli::Command& program) {
  auto options = std::make_shared<Options>();
  cli::Command command = program.add_command("join", "Joins models that overlap into one, exactly");
  command
      .add_option("PART", options->parts,
                  "OBJ, PLY, STL or glTF files of closed models; of one file, its parts are joined")
      .required();
  takes::add_up_option(command, options->up);
  command.add_option("--seam", options->seam,
                     "How far the seam is smeared to each side, in the models' units; 0 leaves it "
                     "sharp");
  command.add_option("--out", options->out, "Where to write the result, .obj, .ply or .stl")
      .required();
  command.add_flag("--force", options->force, cli::force_summary);
  command.on_chosen([options] {
    const auto done = join_files(*options);
    return done ? 0 : cli::report(done.error());
  });
}

} // namespace nendo::app::join_command
