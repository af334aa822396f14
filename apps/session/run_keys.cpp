#include "session/run_keys.hpp"

#include <iostream>
#include <thread>
#include <utility>

#include <nendo/deform/mesh_file.hpp>

#include "cli/cli.hpp"
#include "cli/output_place.hpp"
#include "session/run_options.hpp"

namespace nendo::session {
namespace {

// A line that progress has begun stays as it is.
void tell(const std::string& what) {
  std::cerr << '\n';
  cli::note(what);
}

} // namespace

RunKeys::RunKeys(const RunOptions& options, const deform::Mesh& model, RunRecorder& recorder)
    : requests_(*options.loop.requests), model_(model), out_(options.out), recorder_(recorder) {
  if (!keys_.are_there()) return;
  cli::note(
      "keys: g lets go, takes hold again; c keeps the shape so far; u undoes, r redoes; s saves; " +
      std::string(recorder_.keeps() ? "k keeps the recording of what was just done; " : "") +
      "q ends");
}

bool RunKeys::handle(std::chrono::milliseconds patience, flow::DeformLoop& loop) {
  const auto key = keys_.next(patience);
  if (!key) return true;
  const bool held = loop.frames().front().held;
  if (*key == 'g') ask(held ? flow::Request::let_go : flow::Request::grab);
  if (*key == 'c' || *key == ' ') ask(flow::Request::commit);
  if (*key == 'u') ask(flow::Request::undo);
  if (*key == 'r' || *key == 'U') ask(flow::Request::redo);
  if (*key == 's') wanted_.shape = true;
  if (*key == 'k') wanted_.recording = true;
  if (*key != 'q') return true;
  wait_until_heard();
  return false;
}

// What was asked for just before the end is done before it, if the loop ticks at all.
void RunKeys::wait_until_heard() const {
  const HostTime latest = HostClock::now() + std::chrono::seconds(1);
  while (requests_.size() > 0 && HostClock::now() < latest)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

void RunKeys::ask(flow::Request request) {
  if (!requests_.try_push(request))
    tell("the loop does not answer, so it was not asked to " + std::string(name_of(request)));
}

std::string RunKeys::keep(const flow::SaveRequest& wanted, flow::DeformLoop& loop) {
  std::string words = wanted.shape ? save(loop) : "";
  if (wanted.recording) words += (words.empty() ? "" : "; ") + keep_recording();
  tell(words);
  return words;
}

std::string RunKeys::keep_recording() {
  if (!recorder_.keeps()) return "nothing is kept in memory; start with --keep-last 60s";
  recorder_.keep();
  return "what was just done is being kept";
}

std::string RunKeys::save(flow::DeformLoop& loop) {
  const std::string file = cli::next_free_name(out_, saved_);
  deform::Mesh shape = model_;
  loop.layout().unpack(loop.frames().front().shape, shape.vertices);
  const auto written = deform::write_mesh(file, shape);
  return written ? "saved as " + file : written.error().message;
}

} // namespace nendo::session
