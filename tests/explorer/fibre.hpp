#pragma once
// Fibre: a thread of control with a stack of its own, which runs when it is told to and stops where
// it says so. All fibres of a program run on one thread of the system, so that whoever resumes them
// decides alone what happens when.

#include <functional>
#include <memory>

namespace nendo::explorer {

class Fibre {
public:
  Fibre();
  ~Fibre(); ///< its body must be done
  Fibre(const Fibre&) = delete;
  Fibre& operator=(const Fibre&) = delete;

  /// Sets what the next resume() begins with. The body before must be done, and this one may not
  /// throw.
  void start(std::function<void()> body);
  /// From outside: runs the body until it suspends itself or is done.
  void resume();
  /// From the body: back to who resumed it.
  void suspend();
  [[nodiscard]] bool done() const noexcept { return !body_; }

private:
  struct Context; // the system's, and what the sanitizers want to know

  static void enter();

  std::unique_ptr<Context> context_;
  std::function<void()> body_;
};

} // namespace nendo::explorer
