/// Draws a Drawing with OpenGL into an image. Internal to framework/render: the one file that calls OpenGL is painter.cpp.
#pragma once

#include <memory>

#include "framework/render/drawing.h"
#include "framework/render/gl_context.h"
#include "framework/render/image.h"

namespace tumble::render {

class Painter {
 public:
  /// @param geometries  what a Batch's `geometry` counts; kept on the GL side for the painter's life
  /// @param samples     a pixel, for antialiasing: 1, 2 or 4
  /// @throws UserError when the context cannot do what is needed
  Painter(std::unique_ptr<GlContext> context, const std::vector<Geometry>& geometries, int width, int height, int samples);
  ~Painter();
  Painter(Painter&&) noexcept;

  Image paint(const Drawing& drawing);
  /// "osmesa" or "egl".
  const char* context_name() const;

 private:
  class Body;
  std::unique_ptr<Body> body_;
};

}  // namespace tumble::render
