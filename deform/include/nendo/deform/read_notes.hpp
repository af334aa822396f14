#pragma once
// Notes of readers, with similar notes merged into one.

#include <cstddef>
#include <functional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <nendo/base/api.hpp>

namespace nendo::deform {

/// Notes about data that a reader ignored, changed or guessed (ReadModel::notes).
using ReadNotes = std::vector<std::string>;

/// Merges notes that differ only in their subject: the note names the first subject and counts the
/// others. So a thousand missing textures are one line.
class NENDO_API NoteSum {
public:
  /// Adds the note `before 'subject'after`. Repeated notes count once.
  void add(std::string_view before, std::string_view subject, std::string_view after);
  /// Adds a note without a subject. Repeated notes count once.
  void add(std::string_view note);
  /// Appends all notes, ordered by first occurrence: `before 'first' (and 2 others)after`.
  void append_to(ReadNotes& notes) const;

private:
  struct Kind {
    std::string before, first, after;
    std::set<std::string, std::less<>> subjects;
  };
  std::vector<Kind> kinds_; ///< few: one for each place in the code that adds notes
};

/// Max number of notes of a model.
inline constexpr std::size_t max_notes = 20;

/// Makes each note one printable line, and replaces those beyond max_notes by one that counts them.
NENDO_API void bound_notes(ReadNotes& notes);

/// Formats a name for a note: printable, in single quotes, and without the middle if it is long.
NENDO_API std::string quoted_name(std::string_view name);

} // namespace nendo::deform
