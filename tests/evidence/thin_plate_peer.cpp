// Table 1 of the paper by VTK's thin-plate spline transform with the same control points, and by
// Nendo with one thread and with two, in the same run. VTK's transform has one thread; it solves
// again in every frame, as both of its users would have it: it keeps no factor for frozen points.

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>

#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkThinPlateSplineTransform.h>

#include "bench/deform_frames.hpp"
#include "bench/table1_trial.hpp"
#include "reference/table1.hpp"

namespace {

using namespace nendo::bench;
using namespace nendo::reference;
using nendo::deform::Points;

void assign(const Points& from, vtkPoints& to) {
  to.SetNumberOfPoints(from.cols());
  for (Eigen::Index i = 0; i < from.cols(); ++i)
    to.SetPoint(i, from(0, i), from(1, i), from(2, i));
  to.Modified();
}

class ThinPlates {
public:
  ThinPlates(const Points& plane, const Points& starts) : ends_(random_ends(starts)) {
    assign(plane, *vertices_);
    assign(starts, *starts_);
    transform_->SetBasisToR(); // a thin plate's in three dimensions
    transform_->SetSourceLandmarks(starts_);
    moved_->Allocate(plane.cols());
  }

  void frame(std::size_t n) {
    assign(ends_[n % poses], *targets_);
    transform_->SetTargetLandmarks(targets_);
    transform_->Modified();
    moved_->Reset();
    transform_->TransformPoints(vertices_, moved_);
  }
  /// How far from where it belongs a control point comes.
  double miss(std::size_t n) {
    frame(n);
    double most = 0.0;
    for (Eigen::Index i = 0; i < ends_[n].cols(); ++i) {
      double place[3];
      transform_->TransformPoint(starts_->GetPoint(i), place);
      most =
          std::max(most, (Eigen::Vector3d(place[0], place[1], place[2]) - ends_[n].col(i)).norm());
    }
    return most;
  }

private:
  std::array<Points, poses> ends_;
  vtkNew<vtkPoints> vertices_, starts_, targets_, moved_;
  vtkNew<vtkThinPlateSplineTransform> transform_;
};

/// Frames a second of the thread's own time, the best of many: on a busy machine no less than those
/// that Nendo is measured by.
double measure(const Points& plane, const Points& starts, double seconds) {
  ThinPlates plates(plane, starts);
  if (!(plates.miss(0) < 1e-3)) {
    std::fprintf(stderr, "thin_plate_peer: VTK's spline misses its control points\n");
    std::exit(1);
  }
  BestOfThread best;
  const auto begin = std::chrono::steady_clock::now();
  const std::chrono::duration<double> most(seconds);
  while (best.us() == 0.0 || std::chrono::steady_clock::now() - begin < most)
    best.measure(static_cast<std::size_t>(plane.cols()), [&](std::size_t n) { plates.frame(n); });
  return best.per_second();
}

} // namespace

int main(int argc, char** argv) {
  const double seconds = argc == 2 ? std::atof(argv[1]) : 1.0;
  if (argc > 2 || !(seconds > 0.0 && seconds <= 60.0)) {
    std::fprintf(stderr, "thin_plate_peer: usage: thin_plate_peer [SECONDS A CELL, at most 60]\n");
    return 2;
  }
  std::printf("frames a second, the best of many; x: times VTK's\n");
  std::printf("%25s %21s %22s\n%8s %6s %9s %10s %10s %11s %10s\n", "", "one thread", "two threads",
              "vertices", "radius", "VTK", "Type-1", "Type-2", "Type-1", "Type-2");
  const Points starts = table1_starts();
  for (const Table1Plane& layout : table1_planes) {
    const nendo::deform::Mesh mesh = table1_mesh(layout);
    const Points& plane = mesh.vertices;
    for (const double radius : table1_radii) {
      const double vtk = measure(plane, starts, seconds);
      const Table1Cell cell = measure_table1_cell(mesh, starts, radius, seconds);
      std::printf("%8lld %6.0f %9.0f %8.0f x %8.0f x %9.0f x %8.0f x\n",
                  static_cast<long long>(plane.cols()), radius, vtk, cell.one_thread[0] / vtk,
                  cell.one_thread[1] / vtk, cell.two_threads[0] / vtk, cell.two_threads[1] / vtk);
      std::fflush(stdout);
    }
  }
  return 0;
}
