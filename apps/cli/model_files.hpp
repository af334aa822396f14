#pragma once
// Model files: names for models of several files, and notes from reading them.

#include <string>
#include <vector>

namespace nendo::cli {

/// Returns one name for a model of these files, joined by " + ". Recordings and timelines store it.
std::string name_of_files(const std::vector<std::string>& files);
/// Returns the files of such a name. They may be missing.
std::vector<std::string> files_of_name(const std::string& name);
/// Returns such a name with absolute paths.
std::string absolute_name(const std::string& name);
/// Returns such a name without folders, for display.
std::string short_name(const std::string& name);

/// Prints a note about a model on standard error, once, and stores it. This and the next function
/// are for the main thread.
void note_model(const std::string& text);
/// Returns the notes about all models read so far, for summaries in JSON.
const std::vector<std::string>& model_notes();

} // namespace nendo::cli
