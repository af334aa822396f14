#include <limits>
#include <memory>
#include <span>
#include <vector>

#include <pybind11/stl.h>

#include <nendo/deform/clay.hpp>
#include <nendo/deform/triangles.hpp>
#include <nendo/flow/clay_hands.hpp>

#include "python/hands.hpp"
#include "python/meshes.hpp"

namespace nendo::python {
namespace {

constexpr std::size_t hand_parts = hand::HandBody::part_count;
constexpr std::size_t max_bodies = 64;

using Parts = std::vector<deform::ContactPart>;

/// Clay, and the bodies that press it: either balls or hands.
class PyClay {
public:
  PyClay(const PyMesh& model, std::size_t balls, const std::vector<const Skeleton*>& hands,
         double units_per_metre, const deform::ClayOptions& options)
      : balls_(balls), units_per_metre_(units_per_metre), mesh_(model.mesh),
        shape_(mesh_->vertices, {}),
        clay_(shape_, deform::corners_of_triangles(*mesh_), balls + hands.size(),
              hands.empty() ? 1 : hand_parts, options) {
    for (const Skeleton* hand : hands)
      bodies_.emplace_back(hand->bones);
  }

  Parts balls(const py::object& centre_array, const py::object& radius_array) const {
    const auto count = static_cast<Eigen::Index>(balls_);
    const deform::Points centres = points_of(centre_array, "centres", count);
    const Eigen::VectorXd radii = vector_of(radius_array, "radii", count);
    if (balls_ == 0) throw py::value_error("this clay was made for hands; use press_hands()");
    if (!(radii.array() > 0.0).all()) throw py::value_error("radii: use numbers > 0");
    Parts parts(balls_);
    for (Eigen::Index at = 0; at < count; ++at) {
      deform::ContactPart& part = parts[static_cast<std::size_t>(at)];
      part.corners.fill(centres.col(at));
      part.radii.fill(radii[at]);
      part.frame.translation() = centres.col(at);
    }
    return parts;
  }
  Parts hands(const py::object& poses) {
    if (bodies_.empty()) throw py::value_error("this clay was made for balls; use press()");
    const auto view = view_of(poses, "poses",
                              {static_cast<py::ssize_t>(bodies_.size()), hand::joint_count, 4, 4});
    Parts parts(bodies_.size() * hand_parts);
    const double* from = view.data;
    for (std::size_t at = 0; at < bodies_.size(); ++at) {
      hand::HandPose pose;
      for (Eigen::Isometry3d& joint : pose.joints) {
        joint = motion_of(from, "poses");
        from += 16;
      }
      flow::contact_parts(bodies_[at], pose, units_per_metre_,
                          std::span(parts).subspan(at * hand_parts, hand_parts));
    }
    return parts;
  }
  /// Presses along the whole path. Ctrl-C ends it between two parts of the path.
  deform::ClayReport press(const Parts& parts) {
    for (double before_mm = std::numeric_limits<double>::infinity();;) {
      const deform::ClayReport report = without_gil(mutex_, [&] { return clay_.press_to(parts); });
      if (!is_solved(report.status))
        raise({Errc::failed, std::string(deform::describe(report.status))});
      if (PyErr_CheckSignals() != 0) throw py::error_already_set();
      if (!(report.remaining_path_mm > 0.0) || report.remaining_path_mm >= before_mm) return report;
      before_mm = report.remaining_path_mm;
    }
  }
  py::array vertices() {
    deform::Points points;
    without_gil(mutex_, [&] { shape_.layout().unpack(clay_.shape(), points); });
    return array_of(points);
  }
  double volume() {
    return without_gil(mutex_, [&] { return clay_.volume(); });
  }

private:
  std::mutex mutex_;
  std::size_t balls_;
  double units_per_metre_;
  std::shared_ptr<const deform::Mesh> mesh_;
  std::vector<hand::HandBody> bodies_;
  deform::SculptedShape shape_;
  deform::ClayDeformer clay_;
};

std::unique_ptr<PyClay> make_clay(const PyMesh& mesh, std::size_t balls,
                                  const std::vector<const Skeleton*>& hands, double units_per_metre,
                                  double softness_m, double friction, bool keeps_volume,
                                  bool lies_on_table) {
  constexpr double mm_per_metre = 1000.0;
  if ((balls == 0) == hands.empty()) throw py::value_error("give either balls or hands");
  if (balls + hands.size() > max_bodies)
    throw py::value_error("use at most " + std::to_string(max_bodies) + " bodies");
  for (const Skeleton* hand : hands)
    if (hand == nullptr) throw py::type_error("hands: None is no HandSkeleton");
  deform::ClayOptions options;
  options.units_per_mm = number_in(units_per_metre, "units_per_metre", 1e-9, 1e9) / mm_per_metre;
  options.radius_mm = number_in(softness_m, "softness_m", 1e-6, 1e3) * mm_per_metre;
  options.friction = number_in(friction, "friction", 0.0, 100.0);
  options.keeps_volume = keeps_volume;
  options.lies_on_table = lies_on_table;
  return std::make_unique<PyClay>(mesh, balls, hands, units_per_metre, options);
}

py::dict report_of(const deform::ClayReport& report) {
  py::dict made;
  made["touching"] = report.touching;
  made["penetration_m"] = report.penetration_mm / 1000.0;
  made["volume_change"] = report.volume_change;
  made["moved"] = report.is_moved;
  return made;
}

} // namespace

void add_clay(py::module_& module) {
  py::class_<PyClay>(
      module, "Clay",
      "Clay that bodies push out of their interior: `balls`, a number of them, or "
      "`hands`, a list of HandSkeleton. `units_per_metre` is the scale of the mesh; "
      "`softness_m` the reach of a dent. A closed mesh keeps its volume. If it does not "
      "lie on a table, bodies carry and turn it. Functions release the GIL; threads "
      "use it in turn.")
      .def(py::init(&make_clay), py::arg("mesh"), py::kw_only(), py::arg("balls") = 0,
           py::arg("hands") = std::vector<const Skeleton*>{}, py::arg("units_per_metre") = 1.0,
           py::arg("softness_m") = 0.025, py::arg("friction") = 0.5, py::arg("keeps_volume") = true,
           py::arg("lies_on_table") = true)
      .def(
          "press",
          [](PyClay& own, const py::object& centres, const py::object& radii) {
            return report_of(own.press(own.balls(centres, radii)));
          },
          py::arg("centres"), py::arg("radii"),
          "Moves the balls to `centres` (b, 3) with `radii` (b,), in model units, and deforms the "
          "clay. The first call only places them. Returns a dict: touching, penetration_m, "
          "volume_change, moved. Raises Error.")
      .def(
          "press_hands",
          [](PyClay& own, const py::object& poses) {
            return report_of(own.press(own.hands(poses)));
          },
          py::arg("poses"),
          "Moves the hands to `poses` (h, 26, 4, 4), in metres, as HandSkeleton.pose() returns "
          "them. "
          "Otherwise as press().")
      .def_property_readonly("vertices", &PyClay::vertices, "(n, 3): the shape.")
      .def_property_readonly(
          "volume", &PyClay::volume,
          "The volume after the last press(), in cubic model units; 0 if none is kept.");
}

} // namespace nendo::python
