/// Renders a Drawing with OpenGL into an image. Internal to framework/render; only painter.cpp
/// calls OpenGL.
#pragma once

#include <memory>

#include "framework/render/drawing.h"
#include "framework/render/gl_context.h"
#include "framework/render/image.h"

namespace tumble::render {

class Painter {
 public:
  /// @param geometries  indexed by Batch::geometry; kept in GL memory during the painter's lifetime
  /// @param samples     per pixel, for antialiasing: 1, 2 or 4
  /// @throws UserError when the context lacks a needed feature
  Painter(std::unique_ptr<GlContext> context, const std::vector<Geometry>& geometries, int width,
          int height, int samples);
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
