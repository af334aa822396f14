// nendo doctor: what keeps gloves from working on this machine, and the command that mends it.

#include <algorithm>
#include <array>
#include <iostream>
#include <iterator>
#include <memory>
#include <string>

#include <nlohmann/json.hpp>

#include <nendo/base/text.hpp>

#include "cli/cli.hpp"
#include "cli/json_line.hpp"
#include "doctor/doctor.hpp"
#include "nendo/commands.hpp"

namespace nendo::app::doctor_command {
namespace {

/// The checks, one function for each subject.
constexpr std::array subjects{doctor::check_ports, doctor::check_machine};

std::string_view name_of(doctor::Severity severity) {
  return severity == doctor::Severity::failure ? "failure" : "warning";
}

void print_json(const doctor::Finding& finding) {
  const nlohmann::ordered_json line{{"weight", name_of(finding.severity)},
                                    {"check", finding.check},
                                    {"subject", finding.subject},
                                    {"what", finding.what},
                                    {"remedy", finding.remedy}};
  cli::print_line(line);
}

void print_text(const doctor::Finding& finding) {
  std::cout << name_of(finding.severity) << ": " << finding.subject
            << (finding.subject.empty() ? "" : ": ") << finding.what
            << ". Mend it: " << finding.remedy << '\n';
}

int examine(bool json) {
  std::vector<doctor::Finding> findings;
  std::string looked_at;
  for (const auto check : subjects) {
    doctor::Examination examination = check();
    std::move(examination.findings.begin(), examination.findings.end(),
              std::back_inserter(findings));
    for (const std::string& thing : examination.looked_at)
      looked_at += (looked_at.empty() ? "" : ", ") + printable(thing);
  }
  std::stable_sort(
      findings.begin(), findings.end(), [](const doctor::Finding& a, const doctor::Finding& b) {
        return a.severity == doctor::Severity::failure && b.severity == doctor::Severity::warning;
      });
  for (const doctor::Finding& finding : findings)
    json ? print_json(finding) : print_text(finding);
  if (findings.empty() && !json) std::cout << "Nothing here keeps gloves from working.\n";
  if (!json) std::cout << "Looked at: " << looked_at << ".\n";
  const bool well = findings.empty() || findings.front().severity == doctor::Severity::warning;
  return well ? 0 : static_cast<int>(Errc::failed);
}

} // namespace

void add(cli::Command& program) {
  auto json = std::make_shared<bool>(false);
  cli::Command command = program.add_command(
      "doctor", "Says what keeps gloves from working on this machine, and what mends it");
  command.add_flag("--json", *json, "One JSON object a finding");
  command.set_footer("Exit code 1 if something will not work, 0 if there are warnings only.");
  command.on_chosen([json] { return examine(*json); });
}

} // namespace nendo::app::doctor_command
