#include "stage.hpp"

#include <array>
#include <cstdint>

#include <nendo/deform/triangles.hpp>
#include <vtkActor.h>
#include <vtkCamera.h>
#include <vtkCellArray.h>
#include <vtkGlyph3DMapper.h>
#include <vtkPNGWriter.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkPolyDataNormals.h>
#include <vtkProperty.h>
#include <vtkRenderer.h>
#include <vtkSphereSource.h>
#include <vtkTubeFilter.h>
#include <vtkWindowToImageFilter.h>

namespace vtk_hands {

using namespace nendo;

namespace {
constexpr double bone_radius_m = 0.006;
} // namespace

// The model as VTK has it, on the stage: metres.
class ModelActor {
public:
  explicit ModelActor(const deform::Mesh& model) {
    points_->SetNumberOfPoints(model.vertices.cols());
    data_->SetPoints(points_);
    vtkNew<vtkCellArray> faces;
    deform::for_each_triangle(model, [&](const deform::Triangle& triangle) {
      faces->InsertNextCell(3);
      for (const std::uint32_t vertex : triangle)
        faces->InsertCellPoint(vertex);
    });
    data_->SetPolys(faces);
    normals_->SetInputData(data_);
    normals_->SplittingOff();
    mapper_->SetInputConnection(normals_->GetOutputPort());
    actor->SetMapper(mapper_);
    actor->GetProperty()->SetColor(0.78, 0.66, 0.54);
  }
  void show(const deform::Points& vertices, double units_per_metre) {
    for (Eigen::Index at = 0; at < vertices.cols(); ++at) {
      const Eigen::Vector3d place_m = vertices.col(at) / units_per_metre;
      points_->SetPoint(at, place_m.data());
    }
    points_->Modified();
  }

  vtkNew<vtkActor> actor;

private:
  vtkNew<vtkPoints> points_;
  vtkNew<vtkPolyData> data_;
  vtkNew<vtkPolyDataNormals> normals_;
  vtkNew<vtkPolyDataMapper> mapper_;
};

// The VR Hand: a tube from each joint's parent to it, a ball at each joint.
class HandActor {
public:
  HandActor() {
    points_->SetNumberOfPoints(hand::joint_count);
    for (std::size_t at = 0; at < hand::joint_count; ++at)
      points_->SetPoint(static_cast<vtkIdType>(at), 0.0, 0.0, 0.0);
    vtkNew<vtkCellArray> bones;
    for (std::size_t at = 0; at < hand::joint_count; ++at) {
      const auto parent = hand::parent_of(static_cast<hand::Joint>(at));
      if (!parent) continue;
      bones->InsertNextCell(2);
      bones->InsertCellPoint(static_cast<vtkIdType>(hand::index_of(*parent)));
      bones->InsertCellPoint(static_cast<vtkIdType>(at));
    }
    data_->SetPoints(points_);
    data_->SetLines(bones);
    tubes_->SetInputData(data_);
    tubes_->SetRadius(bone_radius_m);
    tubes_->SetNumberOfSides(12);
    bone_mapper_->SetInputConnection(tubes_->GetOutputPort());
    bones_->SetMapper(bone_mapper_);
    ball_->SetRadius(1.5 * bone_radius_m);
    joint_mapper_->SetInputData(data_);
    joint_mapper_->SetSourceConnection(ball_->GetOutputPort());
    joints_->SetMapper(joint_mapper_);
    bones_->GetProperty()->SetColor(0.35, 0.55, 0.75);
    joints_->GetProperty()->SetColor(0.85, 0.35, 0.25);
  }
  void add_to(vtkRenderer& renderer) {
    renderer.AddActor(bones_);
    renderer.AddActor(joints_);
  }
  void show(const hand::HandPose& pose) {
    for (std::size_t at = 0; at < hand::joint_count; ++at)
      points_->SetPoint(static_cast<vtkIdType>(at), pose.joints[at].translation().data());
    points_->Modified();
  }

private:
  vtkNew<vtkPoints> points_;
  vtkNew<vtkPolyData> data_;
  vtkNew<vtkTubeFilter> tubes_;
  vtkNew<vtkPolyDataMapper> bone_mapper_;
  vtkNew<vtkActor> bones_, joints_;
  vtkNew<vtkSphereSource> ball_;
  vtkNew<vtkGlyph3DMapper> joint_mapper_;
};

struct Stage::Parts {
  explicit Parts(sculpting::LiveLoop& loop) : live(loop), model(loop.model()) {}

  sculpting::LiveLoop& live;
  vtkNew<vtkRenderer> renderer;
  ModelActor model;
  std::array<HandActor, 2> hands;
  std::array<bool, 2> shown{}; ///< hands that the stage has
  bool framed = false;
};

Stage::Stage(sculpting::LiveLoop& live) : parts_(std::make_unique<Parts>(live)) {
  parts_->renderer->SetBackground(0.93, 0.93, 0.95);
  parts_->renderer->AddActor(parts_->model.actor);
  window->SetSize(960, 720);
  window->SetMultiSamples(0);
  window->SetWindowName("Nendo: VTK");
  window->AddRenderer(parts_->renderer);
}

Stage::~Stage() = default;

bool Stage::draw() {
  Parts& parts = *parts_;
  if (!parts.live.update()) return false;
  const flow::Frame& frame = parts.live.frame();
  parts.model.show(parts.live.vertices(), frame.units_per_metre);
  for (std::size_t slot = 0; slot < parts.hands.size(); ++slot) {
    if (!frame.hands[slot].present) continue;
    if (!parts.shown[slot]) parts.hands[slot].add_to(*parts.renderer);
    parts.shown[slot] = true;
    parts.hands[slot].show(frame.hands[slot].pose);
  }
  if (!parts.framed) {
    parts.renderer->ResetCamera();
    parts.renderer->GetActiveCamera()->Azimuth(25.0);
    parts.renderer->ResetCameraClippingRange();
    parts.framed = true;
  }
  window->Render();
  return true;
}

bool Stage::write_picture(const std::string& path) {
  vtkNew<vtkWindowToImageFilter> image;
  image->SetInput(window);
  image->ReadFrontBufferOff();
  vtkNew<vtkPNGWriter> writer;
  writer->SetFileName(path.c_str());
  writer->SetInputConnection(image->GetOutputPort());
  writer->Write();
  return writer->GetErrorCode() == 0;
}

} // namespace vtk_hands
