#pragma once
// What VTK draws: the model and both hands, as the loop's latest frame has them.

#include <memory>
#include <string>

#include <vtkNew.h>
#include <vtkRenderWindow.h>

#include <nendo/sculpting/live_loop.hpp>

namespace vtk_hands {

class Stage {
public:
  /// Keeps the loop, which must outlive it.
  explicit Stage(nendo::sculpting::LiveLoop& live);
  ~Stage();

  /// Draws the latest frame, if there is a new one, and returns whether there was. The loop never
  /// waits for this.
  bool draw();
  /// Writes what the window shows as a PNG file. Returns false if that cannot be written.
  bool write_picture(const std::string& path);

  vtkNew<vtkRenderWindow> window;

private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

} // namespace vtk_hands
