#pragma once
// Opens a puppet's file by its path or name.

#include <string>

#include <nendo/puppet/puppet.hpp>

namespace nendo::app {

struct PuppetFile {
  std::string path;
  std::string model; ///< path of its model, which is beside it
  puppet::Puppet puppet;
};

/// Reads a file, or the shipped puppet of that name ("face"), if there is no such file. Error:
/// bad_input.
Result<PuppetFile> open_puppet(const std::string& name);

} // namespace nendo::app
