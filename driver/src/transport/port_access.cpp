#include "transport/port_access.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include <grp.h>
#include <pwd.h>
#include <sys/stat.h>
#include <unistd.h>

#include "transport/missing_node.hpp"

namespace nendo::driver {
namespace {

// Entries of users and groups longer than this are treated as unknown.
using EntryText = std::array<char, 16384>;

std::string group_name(gid_t id) {
  EntryText text;
  group entry{};
  group* found = nullptr;
  ::getgrgid_r(id, &entry, text.data(), text.size(), &found);
  return found != nullptr ? found->gr_name : std::to_string(id);
}

std::string user_name(uid_t id) {
  EntryText text;
  passwd entry{};
  passwd* found = nullptr;
  ::getpwuid_r(id, &entry, text.data(), text.size(), &found);
  return found != nullptr ? found->pw_name : std::to_string(id);
}

/// True if the user was added to the group, whether or not this session knows it yet.
bool is_listed_in(gid_t id) {
  constexpr int max_groups = 1024;
  std::vector<gid_t> groups(max_groups);
  int count = max_groups;
  EntryText text;
  passwd entry{};
  passwd* found = nullptr;
  ::getpwuid_r(::getuid(), &entry, text.data(), text.size(), &found);
  if (found == nullptr) return false;
  if (::getgrouplist(found->pw_name, found->pw_gid, groups.data(), &count) < 0) return false;
  groups.resize(static_cast<std::size_t>(count));
  return std::find(groups.begin(), groups.end(), id) != groups.end();
}

std::string join_group(gid_t id, const std::string& name) {
  // The commonest trap of all: a session keeps the groups that it began with.
  if (is_listed_in(id))
    return "log out and in again: you are in group " + name + " only since then";
  return "sudo usermod -aG " + name + " $USER, then log in again";
}

} // namespace

PortAccess port_access(const std::string& path) {
  if (::access(path.c_str(), R_OK | W_OK) == 0) return {true, "you", ""};
  return refused_access(path);
}

PortAccess refused_access(const std::string& path) {
  struct stat status{};
  if (::stat(path.c_str(), &status) != 0) {
    if (auto remedy = missing_node(path)) return {false, "", *std::move(remedy), true};
    return {false, "", "plug it in again"};
  }
  constexpr mode_t group_both = S_IRGRP | S_IWGRP;
  constexpr mode_t owner_both = S_IRUSR | S_IWUSR;
  if ((status.st_mode & group_both) == group_both && status.st_gid != 0) {
    const std::string name = group_name(status.st_gid);
    return {false, "group " + name, join_group(status.st_gid, name)};
  }
  const bool owned = (status.st_mode & owner_both) == owner_both && status.st_uid != 0;
  const std::string owner = owned ? "user " + user_name(status.st_uid) : "root";
  return {false, owner, "sudo chown $USER " + path + ", which lasts until it is plugged in again"};
}

} // namespace nendo::driver
