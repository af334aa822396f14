#include "nendo/model_output.hpp"

#include <cstdio>
#include <filesystem>
#include <iostream>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include <nendo/base/text.hpp>
#include <nendo/deform/cut.hpp>
#include <nendo/deform/mesh_file.hpp>

#include "cli/cli.hpp"
#include "cli/output_place.hpp"
#include "cli/print.hpp"

namespace nendo::app {

void ModelOutput::add_to(cli::Command& command, const std::string& out_summary) {
  takes::add_up_option(command, up);
  command.add_option("--out", out, out_summary).required();
  command.add_flag("--force", force, cli::force_summary);
}

Result<deform::Mesh> ModelOutput::read(const std::string& file) const {
  auto model = takes::read_model(file, reading());
  if (!model) return model.error();
  return std::move(model->mesh);
}

Result<void> ModelOutput::check(const std::string& file,
                                std::span<const std::string> models) const {
  if (auto fine = cli::check_place("--out", file, deform::mesh_endings); !fine) return fine;
  for (const std::string& model : models)
    if (auto fine = cli::check_spares(model, "--out", file, force); !fine) return fine;
  return {};
}

Result<void> ModelOutput::write(const std::string& file, const deform::Mesh& mesh) const {
  return takes::write_model(file, mesh, reading().up_axis());
}

void report_model(const std::string& file, const deform::Mesh& mesh, const std::string& more) {
  cli::print("{}: {} vertices, {} faces{}\n", printable(file), mesh.vertices.cols(),
             mesh.face_count(), more);
  std::fflush(stdout);
}

std::string volume_text(const deform::Mesh& mesh) {
  return fmt::format(", volume {:.9g}", deform::volume_of(mesh));
}

void warn_about_reach(const std::string& what, const deform::Box& box, const deform::Points& points,
                      const deform::Supports& supports) {
  if (!deform::reach_all_of(box, points, supports)) return;
  cli::note(fmt::format("{}: reaches all of the model, whose longest side is {:.3g}; use a smaller "
                        "radius to shape only a part of it",
                        what, (box.highest - box.lowest).maxCoeff()));
}

void report_written(const std::string& file) {
  if (!file.empty()) std::cout << "wrote " << printable(file) << std::endl;
}

Result<PuppetFile> open_puppet(const std::string& name) {
  PuppetFile file{name, {}, {}};
  std::error_code ignored;
  if (!std::filesystem::exists(name, ignored)) {
    const auto shipped = cli::shipped_model(name + ".puppet.toml");
    if (!std::filesystem::exists(shipped, ignored))
      return Error{Errc::bad_input, name + ": no such puppet; name a puppet file, or one of the "
                                           "shipped face, moai and spot"};
    file.path = shipped.string();
  }
  auto puppet = puppet::read_puppet(file.path);
  if (!puppet) return puppet.error();
  if (!puppet->is_played())
    return Error{Errc::bad_input,
                 file.path +
                     ": has no points, so hands cannot play it; add [points] and functions, or "
                     "open it with --mask"};
  file.puppet = *std::move(puppet);
  file.model = (std::filesystem::path(file.path).parent_path() / file.puppet.model).string();
  return file;
}

} // namespace nendo::app
