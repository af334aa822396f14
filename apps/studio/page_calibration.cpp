#include "studio/page_calibration.hpp"

#include <chrono>
#include <utility>

#include <nendo/base/text.hpp>

#include "gloves/open_hand.hpp"

namespace nendo::studio {
namespace {

using Look = PageFigures::Look;

constexpr double height_m = 0.33, middle_m = 0.085;

// Linear colours.
const Eigen::Vector3f wrong{0.80F, 0.16F, 0.02F}, right{0.10F, 0.50F, 0.12F};
const Eigen::Vector3f way_colour{0.95F, 0.30F, 0.02F};

void add(const ShownHand& hand, Side side, PageFigures& figures) {
  constexpr double tip_m = 0.010;
  const Look look = hand.look == ShownHand::Look::live    ? Look::live
                    : hand.look == ShownHand::Look::ghost ? Look::ghost
                                                          : Look::glass;
  figures.add(side, hand.pose, look);
  const auto tips = hand.pose.fingertip_positions();
  for (std::size_t finger = 0; finger < hand.marked.size(); ++finger) {
    const Eigen::Vector3d tip = tips.col(static_cast<Eigen::Index>(finger));
    if (hand.marked[finger]) figures.add_mark(tip, tip, tip_m, hand.is_wrong ? wrong : right);
  }
}

} // namespace

PageCalibration::PageCalibration(std::string glove)
    : name_(std::move(glove)), opening_(std::async(std::launch::async, [name = name_] {
        return driver::open_glove(name, std::nullopt, gloves::glove_context());
      })) {}

Result<Wish> PageCalibration::update(PageForm& form, PageFigures& figures) {
  form.part("course");
  if (!course_) {
    form.text("Opening " + printable(name_));
    if (opening_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return Wish{};
    auto opened = opening_.get();
    if (!opened) return opened.error();
    glove_ = *std::move(opened);
    course_ = std::make_unique<CalibrationCourse>(*glove_, calibrate::CalibrationRequest{});
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
    figures.add_mark(from, to, 0.003, way_colour);
  for (const JointMark& joint : picture.joints)
    figures.add_mark(joint.place_m, joint.place_m, 0.0065, colour_of(joint.certainty));
  figures.look_by(picture.view, picture.width_m, height_m, middle_m);
  const auto ended = course_->take_outcome();
  if (!ended) return Wish{};
  if (!*ended) return ended->error();
  if ((*ended)->adapt && (*ended)->finished) learns_for_ = (*ended)->finished->wearer.user;
  return Wish{Go{Screen::start}};
}

} // namespace nendo::studio
