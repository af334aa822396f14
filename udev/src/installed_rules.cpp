#include <nendo/udev/installed_rules.hpp>

#include <cerrno>
#include <cstdint>
#include <system_error>
#include <utility>

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <nendo/base/files.hpp>
#include <nendo/udev/bindings.hpp>
#include <nendo/udev/device_table.hpp>
#include <nendo/udev/rules.hpp>

extern char** environ; // NOLINT(readability-redundant-declaration): POSIX has it in no header

namespace nendo::udev {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t max_bytes = 1U << 20U;

RuleState state_of(const fs::path& path, std::string_view wanted) {
  std::error_code failed;
  const auto status = fs::symlink_status(path, failed);
  if (!fs::exists(status)) return RuleState::missing;
  if (!fs::is_regular_file(status)) return RuleState::foreign;
  const auto text = read_file(path, max_bytes, "udev rules");
  if (!text || !text->starts_with(rule_mark)) return RuleState::foreign;
  return *text == wanted ? RuleState::current : RuleState::outdated;
}

/// Asks the nearest folder that exists, in which the missing ones would be made.
bool may_write_in(fs::path folder) {
  std::error_code failed;
  while (!fs::exists(folder, failed) && folder.has_relative_path())
    folder = folder.parent_path();
  return ::access(folder.c_str(), W_OK | X_OK) == 0;
}

/// Returns true if the program ran and succeeded.
bool run(std::vector<std::string> words) {
  std::vector<char*> argv;
  for (std::string& word : words)
    argv.push_back(word.data());
  argv.push_back(nullptr);
  pid_t pid = 0;
  int status = 0;
  if (::posix_spawn(&pid, argv[0], nullptr, nullptr, argv.data(), environ) != 0) return false;
  while (::waitpid(pid, &status, 0) < 0) {
    if (errno != EINTR) return false;
  }
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

/// Not for all input devices: an X server would set up each keyboard again.
std::vector<std::string> trigger_of_space_mice(const char* udevadm) {
  std::vector<std::string> words{udevadm, "trigger", "--action=change", "--subsystem-match=input"};
  for (const auto& [vendor, products] : space_mouse_numbers())
    words.push_back(products == "????" ? "--property-match=ID_VENDOR_ID=" + std::string(vendor)
                                       : "--property-match=ID_MODEL_ID=" + std::string(products));
  return words;
}

} // namespace

fs::path etc_rules(const fs::path& root) {
  return root / "etc/udev/rules.d";
}

std::vector<RuleFile> rules_in_etc(const fs::path& root) {
  std::vector<RuleFile> files;
  for (const RuleText& file : shipped_rules()) {
    const fs::path path = etc_rules(root) / file.name;
    files.push_back({std::string(file.name), path, state_of(path, file.text)});
  }
  return files;
}

std::vector<RuleFile> rules_in_force(const fs::path& root) {
  std::vector<RuleFile> files;
  for (const RuleText& file : shipped_rules()) {
    RuleFile found{std::string(file.name), etc_rules(root) / file.name, RuleState::missing};
    for (const char* const folder : {"etc", "run", "usr/local/lib", "usr/lib"}) {
      const fs::path path = root / folder / "udev/rules.d" / file.name;
      const RuleState state = state_of(path, file.text);
      if (state == RuleState::missing) continue;
      found.path = path;
      found.state = state;
      break;
    }
    files.push_back(std::move(found));
  }
  return files;
}

Result<std::string> read_bindings(const fs::path& root) {
  const fs::path path = etc_rules(root) / binding_file_name;
  std::error_code failed;
  if (!fs::exists(fs::symlink_status(path, failed))) return std::string{};
  return read_file(path, max_bytes, "udev rules");
}

Result<void> apply(const RuleChange& change) {
  const auto problem = [&](Errc code, const std::string& what) {
    return Error{code, change.path.string() + ": " + what};
  };
  const fs::path folder = change.path.parent_path();
  if (!may_write_in(folder)) {
    return problem(Errc::no_permission,
                   "you may not write there; put sudo before the command (--dry-run only shows)");
  }
  std::error_code failed;
  if (fs::is_symlink(fs::symlink_status(change.path, failed)))
    return problem(Errc::failed, "is a link, which is left alone; remove it yourself");
  if (!change.contents) {
    fs::remove(change.path, failed);
    return failed ? Result<void>(problem(Errc::failed, failed.message())) : Result<void>{};
  }
  fs::create_directories(folder, failed);
  if (auto written = replace_file(change.path, *change.contents); !written) return written;
  using enum fs::perms; // whatever the umask: other users' `nendo doctor` reads it, too
  fs::permissions(change.path, owner_read | owner_write | group_read | others_read, failed);
  return {};
}

std::string refresh_udev() {
  std::error_code failed;
  if (!fs::exists("/run/udev/control", failed))
    return "udev does not run here; the rules count from when it does";
  // Not by PATH: this runs as root.
  for (const char* const udevadm : {"/usr/bin/udevadm", "/bin/udevadm"}) {
    if (::access(udevadm, X_OK) != 0) continue;
    const bool done = run({udevadm, "control", "--reload"}) &&
                      run({udevadm, "trigger", "--action=change", "--subsystem-match=usb",
                           "--subsystem-match=usb-serial", "--subsystem-match=tty"}) &&
                      run(trigger_of_space_mice(udevadm));
    if (done) return "udev has read its rules again and looked at what is plugged in";
    break;
  }
  return "udev could not be notified; run: sudo udevadm control --reload, then plug the device in "
         "again";
}

} // namespace nendo::udev
