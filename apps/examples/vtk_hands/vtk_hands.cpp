// Two simulated hands shape a model, and VTK, which the paper used, draws both: in a window, or in
// a picture of the moment after some seconds.
//   vtk_hands MODEL.obj                 a window, until it is closed
//   vtk_hands MODEL.obj PICTURE.png     without one (VTK wants an X display all the same: xvfb-run)

#include <array>
#include <atomic>
#include <chrono>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include <vtkActor.h>
#include <vtkCallbackCommand.h>
#include <vtkCamera.h>
#include <vtkCellArray.h>
#include <vtkGlyph3DMapper.h>
#include <vtkInteractorStyleTrackballCamera.h>
#include <vtkLine.h>
#include <vtkNew.h>
#include <vtkPNGWriter.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkPolyDataNormals.h>
#include <vtkProperty.h>
#include <vtkRenderWindow.h>
#include <vtkRenderWindowInteractor.h>
#include <vtkRenderer.h>
#include <vtkSphereSource.h>
#include <vtkTubeFilter.h>
#include <vtkWindowToImageFilter.h>

#include <nendo/deform/mesh_file.hpp>
#include <nendo/driver/open_glove.hpp>
#include <nendo/flow/deform_loop.hpp>

namespace {

using namespace nendo;

constexpr std::array sides{Side::left, Side::right};
constexpr double bone_radius_m = 0.006;

// A glove with its ring, from which the loop drinks, and its first sample.
struct Hand {
  SampleRing ring{1024};
  std::unique_ptr<driver::Glove> glove;
  GloveSample first;
};

Result<std::unique_ptr<Hand>> simulated_hand(Side side) {
  auto glove = driver::open_glove("sim:sculpt", side);
  if (!glove) return glove.error();
  auto hand = std::make_unique<Hand>();
  hand->glove = *std::move(glove);
  if (const auto started = hand->glove->start(hand->ring); !started) return started.error();
  while (!hand->ring.try_pop(hand->first))
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  return hand;
}

// The loop on a thread of its own, between the hands and whoever draws.
class Shaping {
public:
  static Result<std::unique_ptr<Shaping>> begin(const deform::Mesh& model) {
    std::unique_ptr<Shaping> shaping(new Shaping);
    std::array<std::optional<flow::Fingertips>, 2> tips;
    std::vector<flow::HandInput> inputs;
    for (const Side side : sides) {
      auto hand = simulated_hand(side);
      if (!hand) return hand.error();
      const flow::HandInput input{&(*hand)->ring, side, {}, (*hand)->first};
      tips[flow::Placement::index_of(side)] =
          input.skeleton(side)
              .pose(hand::joint_angles(input.first, hand::default_calibration()),
                    Eigen::Isometry3d::Identity())
              .fingertip_positions();
      inputs.push_back(input);
      shaping->hands_.push_back(*std::move(hand));
    }
    const auto box = deform::finite_box_of(model.vertices);
    flow::LoopOptions options;
    options.sculptor.deformer.supports =
        deform::one_radius(0.2 * (box.highest - box.lowest).maxCoeff());
    shaping->loop_ = std::make_unique<flow::DeformLoop>(model, flow::place_hands(model, tips),
                                                        std::move(inputs), options);
    shaping->thread_ =
        std::thread([&loop = *shaping->loop_, &over = shaping->over_] { loop.run(over); });
    return shaping;
  }
  ~Shaping() {
    over_ = true;
    if (thread_.joinable()) thread_.join();
    for (auto& hand : hands_)
      hand->glove->stop();
  }
  Shaping(const Shaping&) = delete;
  Shaping& operator=(const Shaping&) = delete;

  flow::DeformLoop& loop() noexcept { return *loop_; }

private:
  Shaping() = default;

  std::vector<std::unique_ptr<Hand>> hands_;
  std::unique_ptr<flow::DeformLoop> loop_;
  std::atomic<bool> over_{false};
  std::thread thread_;
};

// The model as VTK has it, on the stage: metres.
class ModelActor {
public:
  explicit ModelActor(const deform::Mesh& model) {
    points_->SetNumberOfPoints(model.vertices.cols());
    data_->SetPoints(points_);
    vtkNew<vtkCellArray> faces;
    for (std::size_t face = 0; face < model.face_count(); ++face) {
      faces->InsertNextCell(
          static_cast<int>(model.face_starts[face + 1] - model.face_starts[face]));
      for (auto at = model.face_starts[face]; at < model.face_starts[face + 1]; ++at)
        faces->InsertCellPoint(model.face_corners[at]);
    }
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

class Stage {
public:
  Stage(flow::DeformLoop& loop, const deform::Mesh& model) : loop_(loop), model_(model) {
    renderer_->SetBackground(0.93, 0.93, 0.95);
    renderer_->AddActor(model_.actor);
    for (auto& hand : hands_)
      hand.add_to(*renderer_);
    window->SetSize(960, 720);
    window->SetMultiSamples(0);
    window->SetWindowName("Nendo: VTK");
    window->AddRenderer(renderer_);
  }
  // The latest frame, if there is a new one; the loop never waits for this.
  void draw() {
    if (!loop_.frames().update()) return;
    const flow::Frame& frame = loop_.frames().front();
    loop_.layout(frame.model).unpack(frame.shape, vertices_);
    model_.show(vertices_, frame.units_per_metre);
    for (std::size_t slot = 0; slot < hands_.size(); ++slot)
      hands_[slot].show(frame.hands[slot].pose);
    if (!framed_) {
      renderer_->ResetCamera();
      renderer_->GetActiveCamera()->Azimuth(25.0);
      framed_ = true;
    }
    window->Render();
  }

  vtkNew<vtkRenderWindow> window;

private:
  flow::DeformLoop& loop_;
  vtkNew<vtkRenderer> renderer_;
  ModelActor model_;
  std::array<HandActor, 2> hands_;
  deform::Points vertices_;
  bool framed_ = false;
};

void write_picture(Stage& stage, const std::string& path) {
  stage.window->SetOffScreenRendering(1);
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(3);
  while (std::chrono::steady_clock::now() < end) {
    stage.draw();
    std::this_thread::sleep_for(std::chrono::milliseconds(15));
  }
  vtkNew<vtkWindowToImageFilter> image;
  image->SetInput(stage.window);
  image->ReadFrontBufferOff();
  vtkNew<vtkPNGWriter> writer;
  writer->SetFileName(path.c_str());
  writer->SetInputConnection(image->GetOutputPort());
  writer->Write();
}

void open_window(Stage& stage) {
  vtkNew<vtkRenderWindowInteractor> interactor;
  interactor->SetRenderWindow(stage.window);
  vtkNew<vtkInteractorStyleTrackballCamera> style;
  interactor->SetInteractorStyle(style);
  interactor->Initialize();
  interactor->CreateRepeatingTimer(15); // ms
  vtkNew<vtkCallbackCommand> again;
  again->SetClientData(&stage);
  again->SetCallback(
      [](vtkObject*, unsigned long, void* data, void*) { static_cast<Stage*>(data)->draw(); });
  interactor->AddObserver(vtkCommand::TimerEvent, again);
  interactor->Start();
}

} // namespace

int main(int argc, char** argv) {
  if (argc < 2 || argc > 3) {
    std::cerr << "vtk_hands: usage: vtk_hands MODEL.obj [PICTURE.png]\n";
    return 2;
  }
  const auto model = deform::read_mesh(argv[1]);
  if (!model) {
    std::cerr << "vtk_hands: " << model.error().message << "\n";
    return static_cast<int>(model.error().code);
  }
  const auto shaping = Shaping::begin(*model);
  if (!shaping) {
    std::cerr << "vtk_hands: " << shaping.error().message << "\n";
    return static_cast<int>(shaping.error().code);
  }
  Stage stage((*shaping)->loop(), *model);
  if (argc == 3) {
    write_picture(stage, argv[2]);
  } else {
    open_window(stage);
  }
  return 0;
}
