#include "gl/smooth_target.hpp"

#include <algorithm>

#define GL_GLEXT_PROTOTYPES
#include <GL/glcorearb.h>

namespace nendo::gl {

SmoothTarget::~SmoothTarget() {
  drop();
}

void SmoothTarget::drop() noexcept {
  glDeleteFramebuffers(1, &frame_buffer_);
  glDeleteRenderbuffers(1, &colours_);
  glDeleteRenderbuffers(1, &depths_);
  frame_buffer_ = colours_ = depths_ = 0;
}

void SmoothTarget::make(render::Size size, bool smooth) {
  drop();
  size_ = size;
  smooth_ = smooth;
  GLint most = 0;
  glGetIntegerv(GL_MAX_SAMPLES, &most);
  for (int samples = smooth ? std::min<int>(most, max_samples) : 0; samples >= 0; --samples) {
    glGenFramebuffers(1, &frame_buffer_);
    glGenRenderbuffers(1, &colours_);
    glGenRenderbuffers(1, &depths_);
    glBindFramebuffer(GL_FRAMEBUFFER, frame_buffer_);
    glBindRenderbuffer(GL_RENDERBUFFER, colours_);
    glRenderbufferStorageMultisample(GL_RENDERBUFFER, samples, GL_RGBA8, size.width, size.height);
    glBindRenderbuffer(GL_RENDERBUFFER, depths_);
    glRenderbufferStorageMultisample(GL_RENDERBUFFER, samples, GL_DEPTH24_STENCIL8, size.width,
                                     size.height);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, colours_);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_STENCIL_ATTACHMENT, GL_RENDERBUFFER,
                              depths_);
    const bool complete = glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    if (complete) return;
    drop();
  }
}

void SmoothTarget::begin(render::Size size, bool smooth) {
  if (!(size == size_) || smooth != smooth_) make(size, smooth);
  glBindFramebuffer(GL_FRAMEBUFFER, frame_buffer_);
}

void SmoothTarget::end(render::Size shown, int below) const {
  if (frame_buffer_ == 0) return;
  glBindFramebuffer(GL_READ_FRAMEBUFFER, frame_buffer_);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
  glBlitFramebuffer(0, 0, size_.width, size_.height, 0, below, shown.width, below + shown.height,
                    GL_COLOR_BUFFER_BIT, size_ == shown ? GL_NEAREST : GL_LINEAR);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
}

} // namespace nendo::gl
