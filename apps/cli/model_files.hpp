#pragma once
// Files of models: several that are one together, and what was noted about those that were read.

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

/// Prints a note about a model on standard error, once, and keeps it. The main thread alone calls
/// this and the next one.
void note_model(const std::string& text);
/// Returns the notes about all models that the program has read: for summaries in JSON.
const std::vector<std::string>& model_notes();

} // namespace nendo::cli
