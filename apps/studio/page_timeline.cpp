#include "studio/page_timeline.hpp"

#include <algorithm>
#include <filesystem>
#include <utility>
#include <vector>

#include <nendo/base/text.hpp>

#include "cli/model_files.hpp"
#include "commands/commands.hpp"
#include "session/views.hpp"
#include "studio/opened_files.hpp"
#include "studio/page_dialogs.hpp"

namespace nendo::studio {
namespace {

/// Returns whether a page would show the same by both. After an edit, all versions of the model are
/// other objects, and a page that gets another version connects again.
bool are_equal(const flow::ModelVersion& one, const flow::ModelVersion& other) {
  if (&one == &other || (one.number == 0 && other.number == 0)) return true;
  return one.mesh.face_starts == other.mesh.face_starts &&
         one.mesh.face_corners == other.mesh.face_corners &&
         one.mesh.vertices.cols() == other.mesh.vertices.cols() &&
         one.mesh.vertices == other.mesh.vertices;
}

/// Returns the sizes of both hands; that of a side without a track is the usual one.
HandSizes sizes_of(const timeline::Timeline& timeline) {
  HandSizes sizes;
  for (const timeline::HandTrack& track : timeline.hands)
    sizes[flow::Placement::index_of(track.side)] = track.size;
  return sizes;
}

bool are_equal(const HandSizes& some, const HandSizes& others) {
  return std::ranges::equal(some, others, [](const auto& one, const auto& other) {
    return one.length_m == other.length_m && one.breadth_m == other.breadth_m &&
           one.shape == other.shape;
  });
}

/// The hands of a timeline as those of a run, for their bones.
std::vector<flow::HandInput> hand_inputs(const HandSizes& sizes) {
  std::vector<flow::HandInput> inputs;
  for (const Side side : {Side::left, Side::right}) {
    flow::HandInput& input = inputs.emplace_back();
    input.side = input.first.side = side;
    input.wearer.left.size = input.wearer.right.size = sizes[flow::Placement::index_of(side)];
  }
  return inputs;
}

} // namespace

void PageTimeline::open(const Open& wanted) {
  leave();
  panel_ = forms::TimelinePanel();
  timeline_.open(wanted);
}

std::string PageTimeline::title() const {
  const std::string name = std::filesystem::path(timeline_.file()).filename().string();
  return printable(name) + (is_modified() ? " *" : "");
}

void PageTimeline::leave() {
  if (stream_) server_.end_beside();
  stream_.reset();
  model_.reset();
  shape_.reset();
  updated_.reset();
}

Wish PageTimeline::describe_waiting(web::PageForm& form) const {
  form.part("timeline");
  form.text(timeline_.waiting_words());
  form.lines_of(0);
  const bool is_asked = !is_open() && form.button(open_button, "");
  return is_asked ? Wish{Open{}} : Wish{};
}

void PageTimeline::edit(web::PageForm& form, edit::EditSession& session) {
  forms::EditActions actions;
  const commands::Row* const row = form.take_edit_command();
  // A question comes before commands.
  if (row != nullptr && !is_asking()) panel_.add(row->edit->command, actions);
  const forms::TimelineView& view = session.view();
  form.part("edit");
  panel_.describe(form, view, actions);
  form.part("timeline");
  panel_.describe_strip(form, view, actions);
  session.handle(actions);
  const HostTime now = HostClock::now();
  session.advance(to_seconds(now - updated_.value_or(now)));
  updated_ = now;
}

/// Begins to show this version of the model.
Result<void> PageTimeline::present(const edit::EditSession& session,
                                   std::shared_ptr<const flow::ModelVersion> model) {
  const deform::BlockLayout& layout = model->layout();
  if (auto fine = session::check_for_browsers(layout.vertex_count(), most_); !fine) return fine;
  const timeline::Timeline& timeline = session.history().timeline();
  sizes_ = sizes_of(timeline);
  stream_ = std::make_shared<web::FrameStream>(layout, flow::FrameCapacity{});
  server_.present_beside(stream_,
                         web::model_message(layout, model->mesh, hand_inputs(sizes_),
                                            {cli::short_name(timeline_.file()), timeline.rate_hz,
                                             timeline.units_per_metre}),
                         web::pictures_of(model->mesh));
  model_ = std::move(model);
  shape_.reset();
  frame_.settings.mode = flow::Mode::type2; // whose base is the shape
  frame_.units_per_metre = timeline.units_per_metre;
  frame_.held = false;
  frame_.shape = layout.pack();
  return {};
}

/// Another shape is a jump to all of it. The stream gets a frame also if there is nothing new,
/// because a client may need the shape.
Result<void> PageTimeline::show(edit::EditSession& session) {
  if (auto error = session.progress().error) return *std::move(error);
  const auto found = session.shape();
  const auto model = found.shape ? found.shape->model : timeline_.model();
  const bool is_other = !stream_ || !are_equal(*model, *model_) ||
                        !are_equal(sizes_, sizes_of(session.history().timeline()));
  // The page connects again for another version, which would end the drag of a key.
  const bool waits = stream_ && (!found.fresh || session.history().is_trying());
  if (is_other && !waits)
    if (auto presented = present(session, model); !presented) return presented;
  if (!is_other) model_ = model; // the next comparison finds the same object
  if (found.shape && found.shape != shape_ && !(is_other && waits)) {
    shape_ = found.shape;
    frame_.shape.follow(shape_->shape);
    ++frame_.shape_jumps;
  }
  const auto hands = session.hands();
  for (std::size_t slot = 0; slot < hands.size(); ++slot) {
    flow::HandFrame& shown = frame_.hands[slot];
    shown.present = hands[slot].has_value();
    if (!shown.present) continue;
    shown.angles = hands[slot]->angles;
    shown.pose = hands[slot]->pose;
    shown.T_stage_wrist = hands[slot]->T_world_wrist;
  }
  ++frame_.ticks_run;
  frame_.scheduled = frame_.woke = HostClock::now();
  stream_->show(frame_);
  return {};
}

Result<Wish> PageTimeline::update(web::PageForm& form) {
  const auto session = timeline_.read();
  if (!session) return session.error();
  if (*session == nullptr) return describe_waiting(form);
  edit(form, **session);
  const auto shown = show(**session);
  if (shown) return Wish{};
  leave();
  timeline_.close();
  return shown.error();
}

Result<Wish> PageTimeline::ask(web::PageForm& form) {
  const auto answer = ask_to_save(form, timeline_.unsaved());
  return answer ? timeline_.settle(*answer) : Wish{};
}

} // namespace nendo::studio
