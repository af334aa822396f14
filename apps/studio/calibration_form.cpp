// The controls of a calibration.

#include <array>
#include <map>
#include <string>
#include <string_view>

#include "gloves/screen_text.hpp"
#include "studio/calibration_course.hpp"

namespace nendo::studio {

using calibrate::CalibrationKind;
using calibrate::Certainty;
using calibrate::GuideAction;
using calibrate::GuideNotice;
using Look = Form::Look;
using Tone = Form::Tone;

namespace {

std::string key_text(char key) {
  return key == ' ' ? "SPACE" : std::string(1, key);
}

std::string notice_text(const GuideNotice& notice) {
  switch (notice.kind) {
  case GuideNotice::Kind::none:
    break;
  case GuideNotice::Kind::left_out:
    return notice.text + " Start again uses all sensors.";
  case GuideNotice::Kind::will_restart:
    return "Start again, pressed once more, forgets every pose.";
  case GuideNotice::Kind::unfitted:
    return notice.text + " Take the pose again, or start again.";
  }
  return {};
}

struct KindRow {
  CalibrationKind kind;
  std::string_view name;
  std::string_view about;
};
constexpr std::array kinds{
    KindRow{CalibrationKind::quick, "Quick: about a minute",
            "Flat hand and fist. Enough to begin with; fingers are exact to some 3 degrees, the "
            "thumb and spreading to less."},
    KindRow{CalibrationKind::full, "Full: about four minutes",
            "34 poses. All joints are exact to some 2 degrees."},
    KindRow{
        CalibrationKind::touch_up, "Touch up: half a minute",
        "Six poses, after the glove was put on again. Corrects where its sensors have slipped."},
};

} // namespace

std::string_view in_words(Certainty certainty) {
  switch (certainty) {
  case Certainty::sure:
    return "sure";
  case Certainty::less_sure:
    return "less sure";
  case Certainty::average:
    return "as on an average hand";
  case Certainty::estimated:
    break;
  }
  return "stuck, estimated";
}

std::string CalibrationCourse::title() const {
  const std::string side(name_of(side_));
  return stage_ == Stage::before ? "Calibrate the " + side + " hand"
                                 : request_.user + ", " + side + " hand";
}

void CalibrationCourse::describe(Form& form) {
  if (!problem_.empty()) form.text(problem_, Tone::warning);
  switch (stage_) {
  case Stage::before:
    describe_before(form);
    break;
  case Stage::guiding:
    describe_guide(form);
    break;
  case Stage::fitting:
    form.text("Computing ...");
    break;
  case Stage::after:
    describe_after(form);
    break;
  }
  form.separator();
  form.text(glove_.info().model + ", " +
                (latest_ ? gloves::fixed(glove_.stats().rate_hz, 0) + " samples per second"
                         : std::string("silent")),
            Tone::faint);
}

void CalibrationCourse::describe_before(Form& form) {
  if (form.line("your name", request_.user)) follow_name();
  form.lines_of(0);
  for (const std::string& name : recent_names_)
    if (form.button(name, "")) {
      request_.user = name;
      follow_name();
    }
  form.separator();
  for (const KindRow& row : kinds) {
    const bool is_possible = row.kind != CalibrationKind::touch_up || touch_up_refusal_.empty();
    const Look look = !is_possible                ? Look::grey
                      : request_.kind == row.kind ? Look::chosen
                                                  : Look::plain;
    if (form.button(row.name, "", look)) {
      request_.kind = row.kind;
      follow_name();
    }
    form.text(is_possible ? row.about : std::string_view(touch_up_refusal_), Tone::faint);
  }
  form.separator();
  if (request_.kind != CalibrationKind::touch_up)
    form.number("hand length",
                "From the wrist's crease to the tip of the middle finger. Leave it as it is if you "
                "do not know it: the poses show it as well.",
                length_mm_, 140.0F, 230.0F, "mm");
  if (has_kept_) form.check("continue the poses of last time", "", continues_);
  const bool is_possible = !request_.user.empty() && latest_.has_value();
  form.lines_of(1);
  if (form.button("Start", "", is_possible ? Look::chosen : Look::grey)) begin_guide();
  if (request_.user.empty())
    form.text("Type your name, or choose it.", Tone::faint);
  else if (!latest_)
    form.text("Start waits for the glove.", Tone::faint);
}

void CalibrationCourse::describe_actions(Form& form) {
  const bool is_free = !guided_->is_ending();
  form.lines_of(guided_->has_begun() ? 2 : 1);
  for (const calibrate::GuideActionRow& row : calibrate::guide_actions()) {
    const bool is_begin = row.action == GuideAction::begin;
    if (guided_->has_begun() == is_begin) continue;
    const Look look = !is_free ? Look::grey : is_begin ? Look::chosen : Look::plain;
    if (form.button(row.label, std::string(row.help) + " (" + key_text(row.key) + ")", look))
      guided_->act(row.action);
    if (is_begin) return;
  }
}

/// The poses, in their order. One that is taken can be taken again by a click.
void CalibrationCourse::describe_takes(Form& form) {
  std::map<hand::PoseId, int> takes;
  std::optional<std::size_t> asked;
  form.lines_of(0);
  for (std::size_t number = 0; number < guide_->pose_count(); ++number) {
    const int take = ++takes[guide_->pose(number)];
    const std::string name =
        calibrate::title_of(guide_->pose(number)) + (take > 1 ? " " + std::to_string(take) : "");
    const bool is_now = guided_->has_begun() && !guide_->is_done() && number == guide_->number();
    const bool is_kept = guide_->is_kept(number);
    const bool is_pressed =
        form.button(name,
                    std::string(hand::pose_of(guide_->pose(number)).instruction) +
                        (is_kept ? " Taken; a click takes it again." : ""),
                    is_now    ? Look::chosen
                    : is_kept ? Look::done
                              : Look::grey);
    if (is_pressed && is_kept) asked = number;
  }
  if (asked) guided_->ask_for(*asked);
}

void CalibrationCourse::describe_guide(Form& form) {
  if (!guided_->has_begun()) {
    form.text("First, show how far each joint goes.");
  } else if (!guided_->is_ending()) {
    form.text("Pose " + std::to_string(guide_->number() + 1) + " of " +
              std::to_string(guide_->pose_count()) + ": " + calibrate::title_of(guide_->asked()) +
              (guide_->is_again() ? ", once more" : ""));
  }
  describe_actions(form);
  if (const std::string notice = notice_text(guided_->notice()); !notice.empty())
    form.text(notice, Tone::warning);
  form.separator();
  describe_takes(form);
  form.separator();
  if (form.button("Leave",
                  "Closes the calibration. The poses taken so far are kept for the next time. (q)"))
    leave();
}

void CalibrationCourse::describe_after(Form& form) {
  std::map<Certainty, int> counts;
  for (const Sensor sensor : glove_.info().sensors)
    ++counts[calibrate::certainty_of(*finished_, sensor)];
  for (const auto& [certainty, count] : counts)
    form.key(std::to_string(count) + (count == 1 ? " joint: " : " joints: ") +
                 std::string(in_words(certainty)),
             colour_of(certainty));
  form.text("The poses are " +
                gloves::fixed(to_degrees(calibrate::typical_residual_rad(*finished_)), 1) +
                " degrees from the calibration, typically.",
            Tone::faint);
  form.separator();
  form.text("Try it:");
  for (std::size_t at = 0; at < nearest_m_.size(); ++at) {
    const auto& nearest_m = nearest_m_[at];
    const bool is_touched = nearest_m && *nearest_m <= touch_m;
    const std::string pair =
        "thumb, " + std::string(calibrate::in_words(static_cast<hand::Finger>(at + 1)));
    form.text(is_touched  ? pair + ": touched"
              : nearest_m ? pair + ": " + gloves::fixed(1e3 * *nearest_m, 0) + " mm apart at best"
                          : pair,
              is_touched ? Tone::success : Tone::faint);
  }
  form.separator();
  form.check("keep learning while I work",
             "Corrects slowly how far the sensors slip while the glove is worn, as nendo run "
             "--adapt does.",
             adapt_);
  if (form.button("Keep", "Writes the calibration. From now on it is used for this name and glove.",
                  Look::chosen))
    return keep_result();
  form.lines_of(2);
  if (form.button("Take poses again", "Goes back to the poses, to the one that agrees least."))
    return take_again();
  if (form.button("Discard",
                  "Writes nothing, and forgets the poses. An earlier calibration remains."))
    return discard();
  if (!findings_.empty()) form.separator();
  for (const calibrate::Finding& finding : findings_) {
    form.text(finding.text);
    form.text(finding.remedy, Tone::faint);
  }
}

/// Follows the keys that the terminal has.
void CalibrationCourse::press(char key) {
  if (stage_ != Stage::guiding || outcome_) return;
  for (const calibrate::GuideActionRow& row : calibrate::guide_actions())
    if (row.key == key) guided_->act(row.action);
  if (key == 'q') leave();
}

} // namespace nendo::studio
