// The file that tools/minutes compiles to see how fast a machine compiles. It does what much of
// this tree does: Eigen's decompositions, JSON, text, variants and containers. It must not change,
// or figures of before and after cannot be compared.

#include <algorithm>
#include <charconv>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/SVD>

#include <nlohmann/json.hpp>

namespace {

struct Stroke {
  std::vector<Eigen::Vector3d> points;
  double radius = 0;
};
struct Reset {};
struct Rename {
  std::string name;
};
using Command = std::variant<Stroke, Reset, Rename>;

template <class... Functions>
struct Visitor : Functions... {
  using Functions::operator()...;
};
template <class... Functions>
Visitor(Functions...) -> Visitor<Functions...>;

Eigen::Matrix3d rotation_between(const Eigen::Matrix3Xd& from, const Eigen::Matrix3Xd& to) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(to * from.transpose(),
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  return svd.matrixU() * svd.matrixV().transpose();
}

Eigen::MatrixXd weights(const Eigen::Matrix3Xd& centres, const Eigen::Matrix3Xd& values,
                        double radius) {
  Eigen::MatrixXd kernel(centres.cols(), centres.cols());
  for (Eigen::Index row = 0; row < kernel.rows(); ++row)
    for (Eigen::Index column = 0; column < kernel.cols(); ++column) {
      const double r = std::min(1.0, (centres.col(row) - centres.col(column)).norm() / radius);
      kernel(row, column) = std::pow(1 - r, 4) * (4 * r + 1);
    }
  return kernel.ldlt().solve(values.transpose());
}

nlohmann::json as_json(const Command& command) {
  return std::visit(Visitor{
                        [](const Stroke& stroke) {
                          nlohmann::json points = nlohmann::json::array();
                          for (const auto& point : stroke.points)
                            points.push_back({point.x(), point.y(), point.z()});
                          return nlohmann::json{
                              {"kind", "stroke"}, {"radius", stroke.radius}, {"points", points}};
                        },
                        [](const Reset&) { return nlohmann::json{{"kind", "reset"}}; },
                        [](const Rename& rename) {
                          return nlohmann::json{{"kind", "rename"}, {"name", rename.name}};
                        },
                    },
                    command);
}

std::optional<double> number(const std::string& text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

} // namespace

std::string yardstick(const std::vector<std::string>& words, const Eigen::Matrix3Xd& from,
                      const Eigen::Matrix3Xd& to) {
  std::map<std::string, double> numbers;
  for (const auto& word : words)
    if (const auto value = number(word)) numbers.emplace(word, *value);
  const Eigen::Matrix3d turn = rotation_between(from, to);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> axes(from.transpose() * from);
  Stroke stroke;
  for (const auto& [word, value] : numbers)
    stroke.points.push_back(turn * Eigen::Vector3d::Constant(value));
  stroke.radius = weights(from, to, 1 + axes.eigenvalues().maxCoeff()).norm();
  std::ranges::sort(stroke.points, {}, [](const Eigen::Vector3d& point) { return point.norm(); });
  return as_json(stroke).dump() + as_json(Reset{}).dump() + as_json(Rename{words.front()}).dump();
}
