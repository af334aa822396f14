#pragma once
// A dialog in the window that chooses a file to open, or a place to save. Main thread.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace nendo::studio {

class FileDialog {
public:
  enum class Purpose : std::uint8_t { open, save };

  /// Opens the dialog in the next picture. `endings`, such as ".obj", are those of the files that
  /// it lists; the first one is added to a name without one. `beside` is a file in whose folder it
  /// begins, whose name is proposed for saving; or a folder.
  void begin(Purpose purpose, std::string title, std::vector<std::string> endings,
             const std::filesystem::path& beside);
  /// Draws it, if it is open. Returns the chosen file once. Reads the folder when it changes.
  std::optional<std::string> draw();
  bool saves() const noexcept { return purpose_ == Purpose::save; }
  bool is_open() const noexcept { return is_open_ || begins_; }

private:
  struct Entry {
    std::string name;
    bool is_folder = false;
    std::uintmax_t bytes = 0;
  };
  void go_to(const std::filesystem::path& folder);
  void draw_places();
  std::optional<std::string> draw_list();
  std::optional<std::string> draw_end(bool confirmed);
  bool fits(const std::string& name) const;
  std::string ending_added(const std::string& name) const;

  Purpose purpose_ = Purpose::open;
  std::string title_;
  std::vector<std::string> endings_;
  std::filesystem::path folder_;
  std::vector<Entry> entries_;
  std::string trouble_; ///< why the folder cannot be read
  std::string name_;    ///< the file's name, as it was typed or clicked
  bool begins_ = false;
  bool is_open_ = false;
};

} // namespace nendo::studio
