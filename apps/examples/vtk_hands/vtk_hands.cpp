// Gloves shape a model, and VTK, which the paper used, draws both: in a window, or in pictures of
// the first and the last moment. VTK wants an X display for pictures: xvfb-run.

#include <charconv>
#include <chrono>
#include <iostream>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include <vtkCallbackCommand.h>
#include <vtkInteractorStyleTrackballCamera.h>
#include <vtkRenderWindowInteractor.h>

#include <nendo/sculpting/live_loop.hpp>

#include "stage.hpp"

namespace {

using namespace nendo;
using namespace vtk_hands;

constexpr auto usage =
    "vtk_hands: usage: vtk_hands MODEL [--left GLOVE] [--right GLOVE] [--mode type1|type2]\n"
    "                  [--first FIRST.png] [--last LAST.png] [--duration SECONDS]\n"
    "GLOVE is as in `nendo run`: serial:/dev/ttyUSB0, usb:0d7f:0100, sim:grasp, replay:FILE, ...;\n"
    "without any, two hands are simulated. With --first or --last there is no window: pictures of\n"
    "the first and the last moment are written, 3 seconds apart, or until recordings have ended.\n";

struct Arguments {
  std::string model;
  sculpting::LiveOptions live;
  std::string first, last; ///< pictures
  double duration_s = 3.0;
};

bool set_option(std::string_view name, const std::string& value, Arguments& arguments) {
  if (name == "--left") return !(arguments.live.left = value).empty();
  if (name == "--right") return !(arguments.live.right = value).empty();
  if (name == "--first") return !(arguments.first = value).empty();
  if (name == "--last") return !(arguments.last = value).empty();
  if (name == "--mode") {
    const auto mode = flow::mode_named(value);
    arguments.live.mode = mode.value_or(flow::Mode::type1);
    return mode.has_value();
  }
  if (name != "--duration") return false;
  constexpr double longest_s = 3600.0;
  const char* const end = value.data() + value.size();
  const auto read = std::from_chars(value.data(), end, arguments.duration_s);
  return read.ec == std::errc() && read.ptr == end && arguments.duration_s >= 0.0 &&
         arguments.duration_s <= longest_s;
}

std::optional<Arguments> parse(const std::vector<std::string>& words) {
  Arguments arguments;
  for (std::size_t at = 0; at < words.size(); ++at) {
    if (!words[at].starts_with("--")) {
      if (!arguments.model.empty()) return std::nullopt;
      arguments.model = words[at];
      continue;
    }
    const std::string value = at + 1 < words.size() ? words[at + 1] : "";
    if (!set_option(words[at], value, arguments)) {
      std::cerr << "vtk_hands: " << words[at] << " " << value << ": not understood\n";
      return std::nullopt;
    }
    ++at;
  }
  sculpting::LiveOptions& live = arguments.live;
  if (live.left.empty() && live.right.empty()) live.left = live.right = "sim:sculpt";
  return arguments.model.empty() ? std::nullopt : std::optional(arguments);
}

bool keep(Stage& stage, const std::string& path) {
  if (path.empty() || stage.write_picture(path)) return true;
  std::cerr << "vtk_hands: " << path << ": cannot be written\n";
  return false;
}

int write_pictures(Stage& stage, const sculpting::LiveLoop& live, const Arguments& arguments) {
  constexpr std::chrono::milliseconds between(15);
  stage.window->SetOffScreenRendering(1);
  while (!stage.draw())
    std::this_thread::sleep_for(between);
  if (!keep(stage, arguments.first)) return 1;
  const auto end =
      std::chrono::steady_clock::now() + std::chrono::duration<double>(arguments.duration_s);
  while (std::chrono::steady_clock::now() < end && !live.has_ended()) {
    stage.draw();
    std::this_thread::sleep_for(between);
  }
  return keep(stage, arguments.last) ? 0 : 1;
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

int fail(const Error& error) {
  std::cerr << "vtk_hands: " << error.message << "\n";
  return static_cast<int>(error.code);
}

} // namespace

int main(int argc, char** argv) {
  const auto arguments = parse({argv + 1, argv + argc});
  if (!arguments) {
    std::cerr << usage;
    return 2;
  }
  auto live = sculpting::LiveLoop::begin(arguments->model, arguments->live);
  if (!live) return fail(live.error());
  Stage stage(*live);
  if (!arguments->first.empty() || !arguments->last.empty())
    return write_pictures(stage, *live, *arguments);
  open_window(stage);
  return 0;
}
