#include "studio/page_calibration.hpp"

namespace nendo::studio {
namespace {

void add(const ShownHand& hand, Side side, PageFigures& figures) {
  constexpr double tip_m = 0.010;
  figures.add(side, hand.pose, hand.look);
  const auto tips = hand.pose.fingertip_positions();
  for (std::size_t finger = 0; finger < hand.marked.size(); ++finger) {
    const Eigen::Vector3d tip = tips.col(static_cast<Eigen::Index>(finger));
    if (hand.marked[finger]) figures.add_mark(tip, tip, tip_m, mark_colour(hand.is_wrong));
  }
}

} // namespace

Result<Wish> PageCalibration::update(web::PageForm& form, PageFigures& figures) {
  form.part("course");
  if (!course_) {
    const auto glove = visit_.glove();
    if (!glove) return glove.error();
    form.text(visit_.waiting_words());
    if (*glove == nullptr) return Wish{};
    course_ = std::make_unique<CalibrationCourse>(**glove, calibrate::CalibrationRequest{});
    if (const auto started = course_->start(); !started) return started.error();
    return Wish{};
  }
  course_->update();
  const CoursePicture& picture = course_->picture();
  form.title(course_->title(), "");
  course_->describe(form);
  form.part("guide");
  if (picture.ring) form.ring(*picture.ring, picture.warns);
  form.text(picture.words.instruction, Form::Tone::title);
  form.text(picture.words.state, picture.words.warns ? Form::Tone::warning : Form::Tone::faint);
  for (const ShownHand& hand : picture.hands)
    add(hand, course_->side(), figures);
  for (const auto& [from, to] : picture.ways)
    figures.add_mark(from, to, 0.003, way_colour());
  for (const JointMark& joint : picture.joints)
    figures.add_mark(joint.place_m, joint.place_m, ball_radius_m, colour_of(joint.certainty));
  figures.look_by(picture.view, picture.width_m, picture_height_m, middle_height_m);
  return visit_.follow(course_->take_outcome());
}

} // namespace nendo::studio
