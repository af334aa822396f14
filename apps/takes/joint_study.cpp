#include "takes/joint_study.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <span>
#include <string>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include <nendo/base/text.hpp>
#include <nendo/base/units.hpp>
#include <nendo/hand/dense.hpp>
#include <nendo/hand/joint_limits.hpp>

#include "cli/cli.hpp"
#include "takes/recorded_frames.hpp"

namespace nendo::takes {
namespace {

using hand::Angle;

constexpr std::size_t noise_window = 24; // samples, a quarter of a second of most gloves
constexpr double min_moved_rad = 0.02;   // standard deviation; less is no motion to compare

// Rijpkema and Girard, "Computer animation of knowledge-based human grasping", 1991: a finger's DIP
// joint bends by two thirds of its PIP joint.
constexpr double published_dip_per_pip = 2.0 / 3.0;

std::vector<double> column_of(const std::vector<hand::JointAngles>& angles, Angle angle) {
  std::vector<double> column;
  column.reserve(angles.size());
  for (const hand::JointAngles& at : angles)
    column.push_back(at[angle]);
  return column;
}

double percentile(const std::vector<double>& sorted, double part) {
  return sorted[static_cast<std::size_t>(
      std::lround(part * static_cast<double>(sorted.size() - 1)))];
}

/// White noise has second differences with six times its variance. A motion that changes little
/// from sample to sample has hardly any.
double noise_of(std::span<const double> column) {
  std::vector<double> windows;
  for (std::size_t first = 1; first + noise_window < column.size(); first += noise_window) {
    double squares = 0.0;
    for (std::size_t at = first; at < first + noise_window; ++at) {
      const double bend = column[at - 1] - 2.0 * column[at] + column[at + 1];
      squares += bend * bend;
    }
    windows.push_back(squares / (6.0 * static_cast<double>(noise_window)));
  }
  if (windows.empty()) return 0.0;
  std::sort(windows.begin(), windows.end());
  windows.resize((windows.size() + 3) / 4);
  double sum = 0.0;
  for (const double variance : windows)
    sum += variance;
  return std::sqrt(sum / static_cast<double>(windows.size()));
}

JointRange range_of(std::vector<double> column, Angle angle, hand::AngleSource source) {
  const hand::JointLimit& limit = hand::limit_of(angle);
  JointRange range{.source = source, .noise_rad = noise_of(column)};
  const auto outside = std::count_if(column.begin(), column.end(), [&](double at) {
    return at < limit.soft_min_rad || at > limit.soft_max_rad;
  });
  range.beyond = static_cast<double>(outside) / static_cast<double>(column.size());
  std::sort(column.begin(), column.end());
  range.min_rad = column.front();
  range.max_rad = column.back();
  range.low_rad = percentile(column, 0.05);
  range.median_rad = percentile(column, 0.5);
  range.high_rad = percentile(column, 0.95);
  return range;
}

std::vector<JointPair> neighbours() {
  std::vector<JointPair> pairs{{Angle::thumb_mcp_flexion, Angle::thumb_ip_flexion}};
  constexpr std::array mcp{Angle::index_mcp_flexion, Angle::middle_mcp_flexion,
                           Angle::ring_mcp_flexion, Angle::little_mcp_flexion};
  constexpr std::array pip{Angle::index_pip_flexion, Angle::middle_pip_flexion,
                           Angle::ring_pip_flexion, Angle::little_pip_flexion};
  constexpr std::array dip{Angle::index_dip_flexion, Angle::middle_dip_flexion,
                           Angle::ring_dip_flexion, Angle::little_dip_flexion};
  for (std::size_t finger = 0; finger < mcp.size(); ++finger) {
    pairs.push_back({mcp[finger], pip[finger]});
    pairs.push_back({pip[finger], dip[finger], published_dip_per_pip});
  }
  for (const auto& joint : {mcp, pip})
    for (std::size_t finger = 0; finger + 1 < joint.size(); ++finger)
      pairs.push_back({joint[finger], joint[finger + 1]});
  return pairs;
}

/// Columns of angles that the glove measures, less their means; and what they have in common.
struct Covariance {
  std::vector<Angle> angles;
  Eigen::MatrixXd matrix;

  Covariance(const std::vector<hand::JointAngles>& samples, const hand::AngleSources& sources) {
    for (std::size_t at = 0; at <= hand::index_of(Angle::little_dip_flexion); ++at)
      if (sources[at] == hand::AngleSource::measured) angles.push_back(hand::angle_at(at));
    Eigen::MatrixXd table(samples.size(), angles.size());
    for (std::size_t row = 0; row < samples.size(); ++row)
      for (std::size_t column = 0; column < angles.size(); ++column)
        table(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(column)) =
            samples[row][angles[column]];
    table.rowwise() -= table.colwise().mean().eval();
    // A lazy product, because that of large matrices takes seconds to compile.
    matrix = table.transpose().lazyProduct(table) / static_cast<double>(samples.size());
  }

  Eigen::Index index_of(Angle angle) const {
    const auto found = std::find(angles.begin(), angles.end(), angle);
    return found == angles.end() ? -1 : found - angles.begin();
  }
};

void add_pairs(const Covariance& covariance, JointStudy& study) {
  constexpr double least = min_moved_rad * min_moved_rad;
  for (JointPair& pair : neighbours()) {
    const Eigen::Index a = covariance.index_of(pair.one), b = covariance.index_of(pair.other);
    if (a < 0 || b < 0) continue;
    const double variance = covariance.matrix(a, a), of_other = covariance.matrix(b, b);
    if (!(variance > least && of_other > least)) continue;
    const double common = covariance.matrix(a, b);
    pair.correlation = common / std::sqrt(variance * of_other);
    pair.slope = common / variance;
    study.pairs.push_back(pair);
  }
}

void add_components(const Covariance& covariance, JointStudy& study) {
  const double all = covariance.matrix.trace();
  if (!(all > min_moved_rad * min_moved_rad)) return;
  const Eigen::VectorXd variances = hand::eigenvalues_of_symmetric(covariance.matrix);
  double sum = 0.0;
  for (Eigen::Index at = variances.size() - 1; at >= 0; --at)
    study.components.push_back((sum += variances[at]) / all);
}

} // namespace

JointStudy study_joints(const std::vector<hand::JointAngles>& angles, SensorMask sensors,
                        SensorMask left_out) {
  JointStudy study;
  study.samples = angles.size();
  if (angles.empty()) return study;
  const hand::AngleSources sources = hand::angle_sources(sensors, left_out);
  for (std::size_t at = 0; at < hand::angle_count; ++at)
    study.ranges[at] =
        range_of(column_of(angles, hand::angle_at(at)), hand::angle_at(at), sources[at]);
  const Covariance covariance(angles, sources);
  add_pairs(covariance, study);
  add_components(covariance, study);
  return study;
}

Result<std::vector<JointStudy>> study_joints(const std::filesystem::path& path) {
  auto samples = GloveSamples::open(path);
  if (!samples) return samples.error();
  struct Hand {
    std::vector<hand::JointAngles> angles;
    SensorMask sensors, left_out;
    HostTime first, last;
  };
  const recording::Setup& setup = samples->setup();
  std::vector<Hand> hands(setup.hands.size());
  while (samples->next()) {
    if (samples->calibration() == nullptr) continue;
    Hand& hand = hands[samples->glove()];
    const GloveSample& sample = samples->sample();
    if (hand.angles.empty()) hand.first = sample.measured;
    hand.last = sample.measured;
    hand.sensors.bits |= sample.present.bits;
    hand.left_out.bits |= samples->left_out().bits;
    hand.angles.push_back(hand::joint_angles(sample, *samples->calibration(), samples->left_out()));
  }
  std::vector<JointStudy> studies;
  for (std::size_t at = 0; at < hands.size(); ++at) {
    if (hands[at].angles.empty()) continue;
    studies.push_back(study_joints(hands[at].angles, hands[at].sensors, hands[at].left_out));
    studies.back().side = setup.hands[at].side;
    studies.back().is_calibrated = is_calibrated(setup, at);
    studies.back().duration_s = to_seconds(hands[at].last - hands[at].first);
  }
  if (studies.empty())
    return Error{Errc::bad_input, path.string() + ": holds no sample of a glove"};
  return studies;
}

namespace {

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
