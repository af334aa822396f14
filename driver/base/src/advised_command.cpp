#include <nendo/base/advised_command.hpp>

#include <algorithm>
#include <array>
#include <system_error>

namespace nendo {

std::string shell_word(std::string_view text) {
  constexpr std::string_view plain =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789"
      "_-+=:,./@%";
  if (!text.empty() && text.find_first_not_of(plain) == std::string_view::npos)
    return std::string(text);
  std::string word = "'";
  for (const char c : text)
    word += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return word + "'";
}

std::string as_root(std::string_view arguments) {
  std::error_code unknown;
  return as_root(arguments, std::filesystem::read_symlink("/proc/self/exe", unknown));
}

std::string as_root(std::string_view arguments, const std::filesystem::path& program) {
  // Debian's secure_path: sudo does not look into the PATH of the person who types it.
  constexpr std::array<std::string_view, 6> folders{
      "/usr/local/sbin", "/usr/local/bin", "/usr/sbin", "/usr/bin", "/sbin", "/bin"};
  constexpr std::string_view name = "nendo";
  const bool found =
      program.filename() != name ||
      std::find(folders.begin(), folders.end(), program.parent_path().string()) != folders.end();
  return "sudo " + (found ? std::string(name) : shell_word(program.string())) + ' ' +
         std::string(arguments);
}

} // namespace nendo
