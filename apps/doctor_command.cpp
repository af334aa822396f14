// nendo doctor: what keeps gloves from working on this machine, and the command that mends it.

#include <algorithm>
#include <array>
#include <iostream>
#include <memory>

#include <nlohmann/json.hpp>

#include "cli.hpp"
#include "commands.hpp"
#include "doctor.hpp"
#include "json_line.hpp"

namespace nendo::app {
namespace {

/// A subject each.
constexpr std::array subjects{check_ports, check_machine};

std::string_view name_of(Weight weight) {
  return weight == Weight::failure ? "failure" : "warning";
}

void print_json(const Finding& finding) {
  const nlohmann::ordered_json line{{"weight", name_of(finding.weight)},
                                    {"check", finding.check},
                                    {"subject", finding.subject},
                                    {"what", finding.what},
                                    {"remedy", finding.remedy}};
  print_line(line);
}

void print_text(const Finding& finding) {
  std::cout << name_of(finding.weight) << ": " << finding.subject
            << (finding.subject.empty() ? "" : ": ") << finding.what
            << ". Mend it: " << finding.remedy << '\n';
}

int examine(bool json) {
  std::vector<Finding> findings;
  for (const auto check : subjects) {
    for (Finding& finding : check())
      findings.push_back(std::move(finding));
  }
  std::stable_sort(findings.begin(), findings.end(), [](const Finding& a, const Finding& b) {
    return a.weight == Weight::failure && b.weight == Weight::warning;
  });
  for (const Finding& finding : findings)
    json ? print_json(finding) : print_text(finding);
  if (findings.empty() && !json) std::cout << "Nothing here keeps gloves from working.\n";
  const bool well = findings.empty() || findings.front().weight == Weight::warning;
  return well ? 0 : static_cast<int>(Errc::failed);
}

} // namespace

void add_doctor(Command& program) {
  auto json = std::make_shared<bool>(false);
  Command command = program.add_command(
      "doctor", "Says what keeps gloves from working on this machine, and what mends it");
  command.add_flag("--json", *json, "One JSON object a finding");
  command.set_footer("Exit code 1 if something will not work, 0 if there are warnings only.");
  command.on_chosen([json] { return examine(*json); });
}

} // namespace nendo::app
