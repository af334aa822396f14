#include <cstdint>
#include <memory>
#include <string>
#include <utility>

#include <nendo/deform/type1.hpp>
#include <nendo/deform/type2.hpp>
#include <nendo/deform/vertex_mask.hpp>

#include "python/deforming.hpp"

namespace nendo::python {
namespace {

constexpr std::int64_t max_undo_bytes = std::int64_t{1} << 40;

/// The arguments of both types.
struct Arguments {
  py::object radius;
  std::string kernel;
  bool injective;
  double keep_volume;
  py::object mask;
  std::int64_t undo_bytes;
};

deform::DeformerOptions options_of(const Arguments& arguments, Eigen::Index points,
                                   const deform::BlockLayout& layout) {
  deform::DeformerOptions options;
  options.supports = supports_of(arguments.radius, points);
  options.csrbf.kernel = kernel_of(arguments.kernel);
  options.csrbf.keep_volume = number_in(arguments.keep_volume, "keep_volume", 0.0, 1.0);
  if (arguments.injective) options.injective.emplace();
  if (arguments.undo_bytes < 0 || arguments.undo_bytes > max_undo_bytes)
    throw py::value_error("undo_bytes: use 0 to " + std::to_string(max_undo_bytes));
  options.undo_bytes = static_cast<std::size_t>(arguments.undo_bytes);
  if (!arguments.mask.is_none()) {
    const Eigen::VectorXd weights = vector_of(arguments.mask, "mask", layout.original().cols());
    if ((weights.array() < 0.0).any() || (weights.array() > 1.0).any())
      throw py::value_error("mask: use weights from 0 to 1");
    options.mask = std::make_shared<deform::VertexMask>(layout, weights);
  }
  return options;
}

/// A shape, the deformer that works on it, and its control points.
template <class Deformer>
class PyDeformer {
public:
  template <class... More>
  PyDeformer(const py::object& vertices, const py::object& tips, const Arguments& arguments,
             More... more)
      : PyDeformer(layout_of(vertices), points_of(tips, "tips"), arguments, more...) {}

  deform::Points tips_of(const py::object& tips) const { return points_of(tips, "tips", points_); }
  /// Calls with the deformer and the tips, without the GIL, and checks the status.
  template <class Call>
  void call(const py::object& tips, Call act) {
    const deform::Points places = tips_of(tips);
    check(without_gil(mutex_, [&] { return act(deformer_, places); }));
  }
  void go(deform::HistoryMove move, const py::object& tips) {
    call(tips,
         [move](Deformer& deformer, const deform::Points& to) { return deformer.go(move, to); });
  }
  void release() {
    without_gil(mutex_, [&] { deformer_.release(true); });
  }
  py::tuple steps() {
    const auto counts =
        without_gil(mutex_, [this] { return std::pair(shape_.undo_steps(), shape_.redo_steps()); });
    return py::make_tuple(counts.first, counts.second);
  }
  /// Returns the vertices of the shape that `of` returns.
  template <class Of>
  py::array vertices(Of of) {
    deform::Points points;
    without_gil(mutex_, [&] { shape_.layout().unpack(of(deformer_), points); });
    return array_of(points);
  }

  deform::BlockShape applied; ///< the last result of type 1

private:
  template <class... More>
  PyDeformer(deform::BlockLayout layout, const deform::Points& tips, const Arguments& arguments,
             More... more)
      : points_(tips.cols()), options_(options_of(arguments, tips.cols(), layout)),
        shape_(std::move(layout), options_, nullptr),
        deformer_(shape_, points_, more..., options_) {}

  static deform::BlockLayout layout_of(const py::object& vertices) {
    deform::Points points = points_of(vertices, "vertices");
    if (points.cols() == 0) throw py::value_error("vertices: there are none");
    return deform::BlockLayout(std::move(points));
  }

  std::mutex mutex_;
  Eigen::Index points_;
  deform::DeformerOptions options_;
  deform::SculptedShape shape_;
  Deformer deformer_;
};

using Type1 = PyDeformer<deform::Type1Deformer>;
using Type2 = PyDeformer<deform::Type2Deformer>;

std::unique_ptr<Type1> make_type1(const py::object& vertices, const py::object& starts,
                                  const py::object& radius, const std::string& kernel,
                                  bool injective, double keep_volume, const py::object& mask,
                                  std::int64_t undo_bytes) {
  auto made = std::make_unique<Type1>(
      vertices, starts, Arguments{radius, kernel, injective, keep_volume, mask, undo_bytes});
  made->call(starts, [](auto& deformer, const deform::Points& at) { return deformer.grab(at); });
  return made;
}

std::unique_ptr<Type2> make_type2(const py::object& vertices, const py::object& tips,
                                  const py::object& radius, double piece_length,
                                  const std::string& kernel, bool injective, double keep_volume,
                                  const py::object& mask, std::int64_t undo_bytes) {
  auto made = std::make_unique<Type2>(
      vertices, tips, Arguments{radius, kernel, injective, keep_volume, mask, undo_bytes},
      number_in(piece_length, "piece_length", 1e-100, 1e100));
  made->call(tips, [](auto& deformer, const deform::Points& at) { return deformer.begin(at); });
  return made;
}

py::array apply(Type1& own, const py::object& ends) {
  own.call(ends, [&own](auto& deformer, const deform::Points& to) {
    return deformer.apply(to, own.applied);
  });
  return own.vertices([&own](const auto&) -> const deform::BlockShape& { return own.applied; });
}

template <class Own>
void add_history(py::class_<Own>& deformer) {
  using deform::HistoryMove;
  const auto add = [&deformer](const char* name, HistoryMove move, const char* doc) {
    deformer.def(
        name, [move](Own& own, const py::object& tips) { own.go(move, tips); }, py::arg("tips"),
        doc);
  };
  add("undo", HistoryMove::undo,
      "Reverts the last step, and grabs the shape at `tips`. Needs undo_bytes.");
  add("redo", HistoryMove::redo, "Reverts the last undo, and grabs the shape at `tips`.");
  add("reset", HistoryMove::reset, "Restores the first shape, as a step, and grabs it at `tips`.");
  deformer.def("release", &Own::release, "Releases the shape, which stays as it is.")
      .def_property_readonly("steps", &Own::steps,
                             "The numbers of steps that can be undone, and redone.");
}

} // namespace

void add_deformers(py::module_& module) {
  py::class_<Type1> type1(
      module, "Type1Deformer",
      "Deforms vertices (n, 3) from a rest shape (the paper's type 1): grabs it at `starts` (k, "
      "3); "
      "apply() moves these points to other positions. With `injective`, it never folds. With "
      "`keep_volume`, 0 to 1, what is pressed in comes out nearby. `mask` (n,) has weights from 0, "
      "protected, to 1. Results are within 1e-5 of the model's diagonal of Field's. Functions "
      "release the GIL, and raise Error if there is no usable solution; threads use it in turn.");
  type1
      .def(py::init(&make_type1), py::arg("vertices"), py::arg("starts"), py::kw_only(),
           py::arg("radius"), py::arg("kernel") = "wendland-c2", py::arg("injective") = false,
           py::arg("keep_volume") = 0.0, py::arg("mask") = py::none(), py::arg("undo_bytes") = 0)
      .def(
          "grab",
          [](Type1& own, const py::object& tips) {
            own.call(tips,
                     [](auto& deformer, const deform::Points& at) { return deformer.grab(at); });
          },
          py::arg("starts"), "Grabs the rest shape at other points (k, 3).")
      .def("apply", &apply, py::arg("ends"),
           "Returns the rest shape (n, 3), deformed so that the points move to `ends` (k, 3).")
      .def(
          "commit",
          [](Type1& own, const py::object& tips) {
            own.call(tips,
                     [](auto& deformer, const deform::Points& at) { return deformer.commit(at); });
          },
          py::arg("ends"), "Makes the last result the rest shape, and grabs it at `ends` (k, 3).")
      .def_property_readonly(
          "rest",
          [](Type1& own) {
            return own.vertices([](auto& deformer) -> auto& { return deformer.rest(); });
          },
          "(n, 3): the rest shape.");
  add_history(type1);

  py::class_<Type2> type2(
      module, "Type2Deformer",
      "Deforms vertices (n, 3) along the paths of points (the paper's type 2), beginning at `tips` "
      "(k, 3), in pieces of `piece_length`. Other arguments and threads are as in Type1Deformer.");
  type2
      .def(py::init(&make_type2), py::arg("vertices"), py::arg("tips"), py::kw_only(),
           py::arg("radius"), py::arg("piece_length"), py::arg("kernel") = "wendland-c2",
           py::arg("injective") = false, py::arg("keep_volume") = 0.0, py::arg("mask") = py::none(),
           py::arg("undo_bytes") = 0)
      .def(
          "begin",
          [](Type2& own, const py::object& tips) {
            own.call(tips,
                     [](auto& deformer, const deform::Points& at) { return deformer.begin(at); });
          },
          py::arg("tips"), "Ends the stroke, and begins another one at these points (k, 3).")
      .def(
          "stroke_to",
          [](Type2& own, const py::object& tips) {
            own.call(tips, [](auto& deformer, const deform::Points& to) {
              return deformer.stroke_to(to).status;
            });
          },
          py::arg("tips"), "Extends the paths to these points (k, 3), and applies whole pieces.")
      .def(
          "end_at",
          [](Type2& own, const py::object& tips) {
            own.call(tips, [](auto& deformer, const deform::Points& to) {
              return deformer.end_at(to).status;
            });
          },
          py::arg("tips"), "Does the same, but all the way to the points.")
      .def_property_readonly(
          "shape",
          [](Type2& own) {
            return own.vertices([](auto& deformer) -> auto& { return deformer.shape(); });
          },
          "(n, 3): the shape.");
  add_history(type2);
}

} // namespace nendo::python
