#pragma once
// Functions that commands share: the options of those that read and write models (--up, --out and
// --force), their reports, and the files of puppets.

#include <span>
#include <string>

#include <nendo/deform/mesh.hpp>
#include <nendo/deform/supports.hpp>
#include <nendo/puppet/puppet.hpp>

#include "takes/model_files.hpp"

namespace nendo::app {

struct ModelOutput {
  std::string out;
  std::string up; ///< the axis that points up in the files; empty: y
  bool force = false;

  void add_to(cli::Command& command, const std::string& out_summary);
  deform::ReadOptions reading() const { return takes::reading(up); }
  /// Reads one model. Errors: those of takes::read_model().
  Result<deform::Mesh> read(const std::string& file) const;
  /// Checks that `file` can be written and is none of the models. Errors: usage, failed.
  Result<void> check(const std::string& file, std::span<const std::string> models) const;
  /// Writes the mesh. Error: failed.
  Result<void> write(const std::string& file, const deform::Mesh& mesh) const;
};

/// Reports on standard output that a model was written, with its sizes. `more` follows them.
void report_model(const std::string& file, const deform::Mesh& mesh, const std::string& more = {});
/// Returns ", volume 12.5".
std::string volume_text(const deform::Mesh& mesh);

/// Warns on standard error if control points at these places reach all of the model, as where radii
/// are in another unit than the model's. `what` names the radii, as "--radius 20".
void warn_about_reach(const std::string& what, const deform::Box& box, const deform::Points& points,
                      const deform::Supports& supports);

/// Reports on standard output that a file was written. An empty name is no file.
void report_written(const std::string& file);

struct PuppetFile {
  std::string path;
  std::string model; ///< path of its model, which is beside it
  puppet::Puppet puppet;
};

/// Reads a file, or the shipped puppet of that name ("face"), if there is no such file. Error:
/// bad_input.
Result<PuppetFile> open_puppet(const std::string& name);

} // namespace nendo::app
