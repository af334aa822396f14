#include "session/run_saving.hpp"

#include <cstring>
#include <filesystem>
#include <utility>
#include <variant>

#include <nendo/base/files.hpp>

#include "cli/cli.hpp"
#include "cli/output_place.hpp"
#include "commands/commands.hpp"

namespace nendo::session {
namespace {

constexpr std::chrono::milliseconds min_between_saves(250);

} // namespace

Result<void> write_shape(const std::string& out, const deform::Mesh& shape, deform::UpAxis up) {
  const auto written = deform::write_mesh(out, shape, {}, up);
  if (written) {
    for (const std::string& lost : deform::lost_in_file(out, shape))
      cli::note(out + ": " + lost);
    return {};
  }
  const std::filesystem::path wanted(out);
  std::error_code ignored, no_folder;
  auto folder = std::filesystem::temp_directory_path(no_folder);
  if (no_folder) folder = "/tmp"; // TMPDIR may name a place that is not there
  const auto elsewhere = folder / wanted.filename();
  if (std::filesystem::exists(elsewhere, ignored) || !deform::write_mesh(elsewhere, shape, {}, up))
    return written.error();
  return Error{Errc::failed,
               written.error().message + "; the shape is in " + elsewhere.string() + " instead"};
}

RunSaving::RunSaving(const RunOptions& options, RunRecorder& recorder)
    : out_(options.out), up_(options.reading.up_axis()), model_(options.mesh),
      out_puppet_(options.out_puppet), recorder_(recorder) {}

void RunSaving::add(const flow::Command& command) noexcept {
  shape_ = shape_ || std::holds_alternative<flow::SaveShape>(command);
  puppet_ = puppet_ || std::holds_alternative<flow::SavePuppet>(command);
  recording_ = recording_ || std::holds_alternative<flow::SaveRecording>(command);
}

void RunSaving::add(const std::string& file) {
  chosen_ = file;
  shape_ = true;
}

bool RunSaving::is_modified(const flow::Frame& frame) {
  if (frame.ticks_run == 0) return false;
  if (!clean_) clean_ = Version{frame.model, frame.shape};
  if (clean_->model != frame.model) return true;
  for (std::size_t block = 0; block < frame.shape.block_count(); ++block) {
    if (clean_->shape.stamp(block) == frame.shape.stamp(block)) continue;
    // A block may be written again as it was.
    if (std::memcmp(&clean_->shape[block], &frame.shape[block], sizeof(deform::VertexBlock)) != 0)
      return true;
    clean_->shape.follow(frame.shape, block);
  }
  return false;
}

Report RunSaving::save(flow::DeformLoop& loop) {
  Report all("");
  const auto add = [&all](const Report& one) {
    all.text += (all.text.empty() ? "" : "; ") + one.text;
    all.is_error = all.is_error || one.is_error;
  };
  if (std::exchange(shape_, false)) add(save_shape(loop));
  if (std::exchange(recording_, false)) add(save_recording());
  if (std::exchange(puppet_, false)) add(save_puppet(loop));
  next_ = HostClock::now() + min_between_saves;
  return all;
}

Report RunSaving::save_recording() {
  if (!recorder_.keeps_last_minute()) return {commands::nothing_kept, true};
  recorder_.save_last_minute();
  return "what was just done is being kept";
}

/// Only the file that was opened, or that was saved before, is written over.
Report RunSaving::save_puppet(const flow::DeformLoop& loop) {
  const auto& rig = loop.changes().puppet(loop.changes().newest_puppet());
  if (!rig || out_puppet_.file.empty()) return {"there is no puppet or mask to save", true};
  std::error_code ignored;
  if (!out_puppet_.may_be_replaced && std::filesystem::exists(out_puppet_.file, ignored)) {
    int number = 1;
    out_puppet_.file = cli::next_free_name(out_puppet_.file, number);
  }
  puppet::Puppet puppet = rig->puppet();
  const auto name = cli::name_beside(model_, out_puppet_.file);
  if (!name) return name.error();
  if (puppet.model != *name) {
    puppet.model = *name;
    puppet.text = puppet::text_of(puppet);
  }
  puppet::count_from(-loop.changes().model(0)->mesh.offset, puppet);
  const auto written = replace_file(out_puppet_.file, puppet.text);
  if (!written) return written.error();
  out_puppet_.may_be_replaced = true;
  return (puppet.is_played() ? "the puppet is saved as " : "the mask is saved as ") +
         out_puppet_.file;
}

Report RunSaving::save_shape(flow::DeformLoop& loop) {
  const std::string file = chosen_.empty() ? cli::next_free_name(out_, saved_) : chosen_;
  const flow::Frame& frame = loop.frames().front();
  deform::Mesh shape = loop.changes().model(frame.model)->mesh;
  loop.changes().layout(frame.model).unpack(frame.shape, shape.vertices);
  const auto written = deform::write_mesh(file, shape, {}, up_);
  if (!written) return written.error();
  clean_ = Version{frame.model, frame.shape};
  saved_file_ = file;
  ++saves_;
  return "saved as " + file;
}

} // namespace nendo::session
