// nendo doctor: finds problems with gloves and trackers on this machine, and the commands that fix
// them.

#include <algorithm>
#include <array>
#include <iostream>
#include <iterator>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include <nendo/base/advised_command.hpp>
#include <nendo/base/text.hpp>
#include <nendo/driver/devices.hpp>
#include <nendo/sculpting/find_wearer.hpp>

#include "cli/cli.hpp"
#include "doctor/doctor.hpp"
#include "gloves/open_hand.hpp"
#include "gloves/open_tracker.hpp"
#include "gloves/stuck_sensors.hpp"
#include "nendo/commands.hpp"
#include "nendo/tracker_commands.hpp"

namespace nendo::app::doctor_command {
namespace {

struct Options {
  std::string device; ///< GLOVE or TRACKER; empty: each identified glove
  bool is_tracker = false;
  bool json = false;
};

/// Finds sensors that were stuck during a calibration.
doctor::Examination check_calibrations() {
  doctor::Examination examination{{}, {"stored calibrations"}};
  for (const auto& file : sculpting::stored_calibrations(cli::note).files) {
    if (file.wearer.left_out.bits == 0) continue;
    const bool one = sculpting::is_one(file.wearer.left_out);
    examination.findings.push_back({doctor::Severity::warning, "stuck_sensor", file.path.string(),
                                    sculpting::sensors_in_words(file.wearer.left_out) +
                                        (one ? " was" : " were") + " stuck when " +
                                        sculpting::title_of(file.wearer) +
                                        " was calibrated, so their values are estimated",
                                    "repair the sensor or its wire, then calibrate again"});
  }
  return examination;
}

/// Finds sensors of an open glove that are at an end of their range now.
std::vector<doctor::Finding> sensors_of(driver::Glove& glove, const std::string& spec) {
  std::vector<doctor::Finding> findings;
  for (const gloves::SensorAtEnd& found : gloves::sensors_at_end(glove))
    findings.push_back({doctor::Severity::warning, "stuck_sensor", spec, gloves::in_words(found),
                        "bend that joint while `nendo monitor " + shell_word(spec) +
                            "` shows it; if it is broken, calibrations and runs leave it out "
                            "automatically"});
  return findings;
}

Result<doctor::Examination> check_glove(const std::string& spec) {
  const auto glove = gloves::open_glove(spec);
  if (!glove) return glove.error();
  return doctor::Examination{sensors_of(**glove, spec), {spec}};
}

/// Checks the identified gloves that no program uses. Other checks report why a glove cannot be
/// opened.
doctor::Examination check_known_gloves() {
  doctor::Examination examination;
  for (const driver::DeviceCandidate& candidate : driver::find_devices()) {
    const bool is_glove = candidate.identified && !candidate.spec.empty();
    if (!is_glove || !candidate.may_open || !candidate.holders.empty()) continue;
    auto examined = check_glove(candidate.spec);
    if (!examined) continue;
    examination.looked_at.push_back("sensors of " + candidate.spec);
    std::move(examined->findings.begin(), examined->findings.end(),
              std::back_inserter(examination.findings));
  }
  return examination;
}

/// The checks, one function for each subject.
constexpr std::array subjects{doctor::check_ports, doctor::check_machine, doctor::check_openxr,
                              check_calibrations};

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
            << (finding.subject.empty() ? "" : ": ") << finding.what << ". Fix: " << finding.remedy
            << '\n';
}

int examine(const Options& options) {
  std::vector<doctor::Finding> findings;
  std::string looked_at;
  std::vector<doctor::Examination> examinations;
  examinations.reserve(std::size(subjects));
  for (const auto check : subjects)
    examinations.push_back(check());
  if (options.device.empty()) {
    examinations.push_back(check_known_gloves());
  } else {
    auto examined = gloves::is_tracker(options.device, options.is_tracker)
                        ? check_tracker(options.device)
                        : check_glove(options.device);
    if (!examined) return cli::report(examined.error());
    examinations.push_back(*std::move(examined));
  }
  for (doctor::Examination& examination : examinations) {
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
    options.json ? print_json(finding) : print_text(finding);
  if (findings.empty() && !options.json) std::cout << "No problems found.\n";
  if (!options.json) std::cout << "Checked: " << looked_at << ".\n";
  const bool well = findings.empty() || findings.front().severity == doctor::Severity::warning;
  return well ? 0 : static_cast<int>(Errc::failed);
}

} // namespace
} // namespace nendo::app::doctor_command

void nendo::app::add_doctor(cli::Command& program) {
  using namespace doctor_command;
  cli::Command command = program.add_command(
      "doctor", "Finds problems with gloves and trackers on this machine, and how to fix them");
  Options& options = command.on_chosen<Options>(examine);
  command.add_option(
      "DEVICE", options.device,
      "Also check the sensors of this GLOVE, or a second of this TRACKER's poses: "
      "serial:/dev/ttyUSB0, auto, fastrak:/dev/ttyUSB1, ...; without it, the sensors of each "
      "identified glove");
  gloves::add_tracker_flag(command, options.is_tracker);
  command.add_flag("--json", options.json, "One JSON object per finding");
  command.set_footer("Exit code 1 if there is a failure, 0 if there are only warnings.");
}
