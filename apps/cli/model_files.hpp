#pragma once
// Several files that are one model together.

#include <string>
#include <vector>

namespace nendo::cli {

/// Returns one name for all of them: theirs, with " + " between. Recordings and timelines keep it.
std::string name_of_files(const std::vector<std::string>& files);
/// Returns the files, of which some may be missing.
std::vector<std::string> files_of_name(const std::string& name);
/// Returns that name with absolute paths.
std::string absolute_name(const std::string& name);
/// Returns that name without folders, for people.
std::string short_name(const std::string& name);

} // namespace nendo::cli
