#include "gl/shadow_map.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#define GL_GLEXT_PROTOTYPES
#include <GL/glcorearb.h>

namespace nendo::gl {

using Eigen::AlignedBox3f;
using Eigen::Matrix4f;
using Eigen::Vector3f;

namespace {

constexpr float min_slack_m = 0.004F; // as in pictures (lights.cpp)
constexpr float edge_samples = 8.0F;  // stay empty, so that the map's edge casts no shadow

} // namespace

ShadowMap::ShadowMap(int side) : side_(side) {
  glGenTextures(1, &texture_);
  glBindTexture(GL_TEXTURE_2D, texture_);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT24, side_, side_, 0, GL_DEPTH_COMPONENT,
               GL_UNSIGNED_INT, nullptr);
  // Outside of the map, everything is lit.
  constexpr std::array<float, 4> lit{1.0F, 1.0F, 1.0F, 1.0F};
  glTexParameterfv(GL_TEXTURE_2D, GL_TEXTURE_BORDER_COLOR, lit.data());
  for (const auto& [name, value] : std::array<std::pair<GLenum, GLenum>, 6>{
           {{GL_TEXTURE_MIN_FILTER, GL_LINEAR},
            {GL_TEXTURE_MAG_FILTER, GL_LINEAR},
            {GL_TEXTURE_WRAP_S, GL_CLAMP_TO_BORDER},
            {GL_TEXTURE_WRAP_T, GL_CLAMP_TO_BORDER},
            {GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE},
            {GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL}}})
    glTexParameteri(GL_TEXTURE_2D, name, static_cast<GLint>(value));
  GLint before = 0;
  glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &before);
  glGenFramebuffers(1, &frame_buffer_);
  glBindFramebuffer(GL_FRAMEBUFFER, frame_buffer_);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, texture_, 0);
  glDrawBuffer(GL_NONE);
  glReadBuffer(GL_NONE);
  is_there_ = glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
  glBindFramebuffer(GL_FRAMEBUFFER, static_cast<GLuint>(before));
}

ShadowMap::~ShadowMap() {
  glDeleteFramebuffers(1, &frame_buffer_);
  glDeleteTextures(1, &texture_);
}

bool ShadowMap::begin(const AlignedBox3f& casting, const Vector3f& toward) {
  if (!is_there_ || casting.isEmpty() || !casting.sizes().allFinite()) return false;
  const Vector3f other = std::abs(toward.y()) < 0.9F ? Vector3f::UnitY() : Vector3f::UnitX();
  Eigen::Matrix3f rows;
  rows.row(0) = other.cross(toward).normalized();
  rows.row(1) = toward.cross(Vector3f(rows.row(0).transpose()));
  rows.row(2) = toward;
  AlignedBox3f box; // in the light's axes
  for (int corner = 0; corner < 8; ++corner)
    box.extend(rows * casting.corner(static_cast<AlignedBox3f::CornerType>(corner)));
  const float across = std::max(1e-3F, box.sizes().head<2>().maxCoeff());
  const float sample_m = across / (static_cast<float>(side_) - 2.0F * edge_samples);
  slack_m_ = std::max(min_slack_m, 2.0F * sample_m);
  const float half = static_cast<float>(side_) * sample_m / 2.0F;
  const float half_deep = box.sizes().z() / 2.0F + 2.0F * slack_m_;
  const Vector3f middle = box.center();
  map_of_world_ = Matrix4f::Identity();
  for (int axis = 0; axis < 3; ++axis) {
    const float scale = axis < 2 ? 1.0F / half : -1.0F / half_deep; // the light sees the nearest
    map_of_world_.block<1, 3>(axis, 0) = scale * rows.row(axis);
    map_of_world_(axis, 3) = -scale * middle[axis];
  }
  glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &before_);
  glBindFramebuffer(GL_FRAMEBUFFER, frame_buffer_);
  glViewport(0, 0, side_, side_);
  // A surface nearly along the light is deeper within a sample than any slack.
  glEnable(GL_POLYGON_OFFSET_FILL);
  glPolygonOffset(3.0F, 4.0F);
  glClear(GL_DEPTH_BUFFER_BIT);
  return true;
}

void ShadowMap::end() const {
  glDisable(GL_POLYGON_OFFSET_FILL);
  glBindFramebuffer(GL_FRAMEBUFFER, static_cast<GLuint>(before_));
}

} // namespace nendo::gl
