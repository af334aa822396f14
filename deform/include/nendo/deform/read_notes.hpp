#pragma once
// Notes of readers: what is alike becomes one of them.

#include <cstddef>
#include <functional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <nendo/base/api.hpp>

namespace nendo::deform {

/// What a reader left out, changed or guessed (ReadModel::notes).
using ReadNotes = std::vector<std::string>;

/// Sums notes that differ in their subject alone: the first subject is named, and the others are
/// counted. So a thousand textures that are missing are one line.
class NENDO_API NoteSum {
public:
  /// Adds the note `before 'subject'after`. A subject that was added with these words before counts
  /// once.
  void add(std::string_view before, std::string_view subject, std::string_view after);
  /// Adds a note that has no subject, once.
  void add(std::string_view note);
  /// Appends all notes, in the order in which their kinds came: `before 'first' (and 2
  /// others)after`.
  void append_to(ReadNotes& notes) const;

private:
  struct Kind {
    std::string before, first, after;
    std::set<std::string, std::less<>> subjects;
  };
  std::vector<Kind> kinds_; ///< few: one for each place in the code that adds notes
};

/// The most notes that a model has.
inline constexpr std::size_t max_notes = 20;

/// Makes each note one printable line, and of those beyond max_notes one that counts them.
NENDO_API void bound_notes(ReadNotes& notes);

/// Returns a name for a note: printable, in single quotes, and without the middle if it is long.
NENDO_API std::string quoted_name(std::string_view name);

} // namespace nendo::deform
