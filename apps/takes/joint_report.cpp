#include "takes/joint_report.hpp"

#include <cstdio>
#include <string>

#include <nlohmann/json.hpp>

#include <nendo/base/text.hpp>
#include <nendo/base/units.hpp>
#include <nendo/hand/joint_limits.hpp>

#include "cli/json_line.hpp"

namespace nendo::takes {
namespace {

using hand::Angle;
using nlohmann::ordered_json;

// Santello, Flanders and Soechting, "Postural hand synergies for tool use", 1998: two principal
// components hold more than this part of the variance of 15 joint angles of many grasps.
constexpr double published_two_components = 0.8;

void print_range(Angle angle, const JointRange& range) {
  const hand::JointLimit& limit = hand::limit_of(angle);
  std::printf("  %-20s", std::string(hand::name_of(angle)).c_str());
  for (const double angle_rad :
       {range.min_rad, range.low_rad, range.median_rad, range.high_rad, range.max_rad})
    std::printf(" %7.1f", to_degrees(angle_rad));
  std::printf("   %4.0f to %3.0f %5.0f %% %7.2f%s\n", to_degrees(limit.soft_min_rad),
              to_degrees(limit.soft_max_rad), 100.0 * range.beyond, to_degrees(range.noise_rad),
              hand::is_estimated(range.source) ? "  estimated" : "");
}

void print_pair(const JointPair& pair) {
  const std::string names =
      std::string(hand::name_of(pair.one)) + " and " + std::string(hand::name_of(pair.other));
  std::printf("  %-41s r %5.2f, slope %5.2f", names.c_str(), pair.correlation, pair.slope);
  if (pair.published_slope) std::printf("; published: %.2f", *pair.published_slope);
  std::printf("\n");
}

void print_hand(const JointStudy& study) {
  std::printf("%s hand: %zu samples in %.1f s%s\n", std::string(name_of(study.side)).c_str(),
              study.samples, study.duration_s,
              study.is_calibrated ? ""
                                  : "; it was not calibrated, so angles are an average hand's");
  std::printf("  %-20s %7s %7s %7s %7s %7s   %11s %7s %7s\n", "degrees", "least", "5 %", "median",
              "95 %", "most", "published", "beyond", "noise");
  for (std::size_t at = 0; at < study.ranges.size(); ++at)
    if (study.ranges[at].source != hand::AngleSource::zero)
      print_range(hand::angle_at(at), study.ranges[at]);
  for (const JointPair& pair : study.pairs)
    print_pair(pair);
  if (study.components.size() < 4) return;
  std::printf("  two principal components hold %.0f %% of the fingers' variance, four %.0f %%; "
              "published for grasps: two hold more than %.0f %%\n",
              100.0 * study.components[1], 100.0 * study.components[3],
              100.0 * published_two_components);
}

ordered_json json_of(const JointStudy& study) {
  ordered_json hand{{"hand", name_of(study.side)},
                    {"samples", study.samples},
                    {"duration_s", study.duration_s},
                    {"calibrated", study.is_calibrated}};
  for (std::size_t at = 0; at < study.ranges.size(); ++at) {
    const JointRange& range = study.ranges[at];
    if (range.source == hand::AngleSource::zero) continue;
    const hand::JointLimit& limit = hand::joint_limits[at];
    hand["joints"].push_back({{"joint", hand::angle_names[at]},
                              {"source", hand::name_of(range.source)},
                              {"min_deg", to_degrees(range.min_rad)},
                              {"p5_deg", to_degrees(range.low_rad)},
                              {"median_deg", to_degrees(range.median_rad)},
                              {"p95_deg", to_degrees(range.high_rad)},
                              {"max_deg", to_degrees(range.max_rad)},
                              {"published_min_deg", to_degrees(limit.soft_min_rad)},
                              {"published_max_deg", to_degrees(limit.soft_max_rad)},
                              {"beyond", range.beyond},
                              {"noise_deg", to_degrees(range.noise_rad)}});
  }
  hand["pairs"] = ordered_json::array();
  for (const JointPair& pair : study.pairs)
    hand["pairs"].push_back({{"one", hand::name_of(pair.one)},
                             {"other", hand::name_of(pair.other)},
                             {"correlation", pair.correlation},
                             {"slope", pair.slope}});
  hand["components"] = study.components;
  return hand;
}

} // namespace

void print_joints(const std::string& file, const std::vector<JointStudy>& studies) {
  std::printf("%s\n", printable(file).c_str());
  for (const JointStudy& study : studies)
    print_hand(study);
}

void print_joints_json(const std::string& file, const std::vector<JointStudy>& studies) {
  ordered_json line{{"file", file}};
  for (const JointStudy& study : studies)
    line["hands"].push_back(json_of(study));
  cli::print_line(line);
}

} // namespace nendo::takes
