#include <nendo/deform/read_notes.hpp>

#include <algorithm>

#include <nendo/base/text.hpp>

namespace nendo::deform {

void NoteSum::add(std::string_view before, std::string_view subject, std::string_view after) {
  auto kind = std::find_if(kinds_.begin(), kinds_.end(), [&](const Kind& known) {
    return known.before == before && known.after == after;
  });
  if (kind == kinds_.end())
    kind = kinds_.insert(kinds_.end(),
                         Kind{std::string(before), std::string(subject), std::string(after), {}});
  if (!kind->subjects.contains(subject)) kind->subjects.emplace(subject);
}

void NoteSum::add(std::string_view note) {
  add(note, {}, {});
}

void NoteSum::append_to(ReadNotes& notes) const {
  for (const Kind& kind : kinds_) {
    std::string note = kind.before;
    if (!kind.first.empty()) note += " " + quoted_name(kind.first);
    const std::size_t others = kind.subjects.size() - 1;
    if (others > 0)
      note += " (and " + std::to_string(others) + (others == 1 ? " other)" : " others)");
    notes.push_back(note + kind.after);
  }
}

void bound_notes(ReadNotes& notes) {
  for (std::string& note : notes) {
    constexpr std::size_t max_note_length = 400;
    if (note.size() > max_note_length) note = note.substr(0, max_note_length - 3) + "...";
    note = printable(note);
  }
  if (notes.size() <= max_notes) return;
  const std::size_t others = notes.size() - (max_notes - 1);
  notes.resize(max_notes - 1);
  notes.push_back("and " + std::to_string(others) + " notes more");
}

std::string quoted_name(std::string_view name) {
  constexpr std::size_t max_length = 80;
  std::string shown = printable(name);
  if (shown.size() > max_length)
    shown = shown.substr(0, max_length / 2) + "..." + shown.substr(shown.size() - max_length / 2);
  return "'" + shown + "'";
}

} // namespace nendo::deform
