#include "discovery/stable_names.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "transport/open_transport.hpp"
#include "transport/sysfs.hpp"

namespace nendo::driver {

std::map<std::string, PortLinks> find_port_links() {
  std::map<std::string, PortLinks> links;
  for (const auto& [folder, member] : {std::pair{"/dev/nendo/", &PortLinks::nendo},
                                       {"/dev/serial/by-id/", &PortLinks::by_id},
                                       {"/dev/serial/by-path/", &PortLinks::by_path}}) {
    std::vector<std::string> names = names_in(folder);
    std::sort(names.begin(), names.end()); // so that it is always the same one of several
    for (const std::string& name : names) {
      std::string& link = links[resolve_port(folder + name)].*member;
      if (link.empty()) link = folder + name;
    }
  }
  return links;
}

} // namespace nendo::driver
