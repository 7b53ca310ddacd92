/// OpenGL contexts without a screen. One interface with two implementations: OSMesa, and EGL
/// without a surface for a Mesa that has dropped OSMesa. Both draw into a framebuffer object of
/// this program, so that their pictures match.
#pragma once

#include <memory>
#include <string>

#include "framework/render/gl_functions.h"

namespace tumble::render {

/// An OpenGL 3.3 core context. A thread has at most one current context; hold a `Current` around
/// every use.
class GlContext {
 public:
  virtual ~GlContext() = default;
  virtual void make_current() = 0;
  virtual void release() = 0;
  const GlFunctions& gl() const { return gl_; }
  /// Name of the implementation, "osmesa" or "egl".
  virtual const char* name() const = 0;

 protected:
  GlFunctions gl_;
};

/// Makes a context current during its own lifetime.
class Current {
 public:
  explicit Current(GlContext& context) : context_(context) { context_.make_current(); }
  ~Current() { context_.release(); }
  Current(const Current&) = delete;
  Current& operator=(const Current&) = delete;

 private:
  GlContext& context_;
};

/// The two implementations. Their libraries are loaded on first use, so that other commands do not
/// pay for them.
/// @throws UserError with what is missing
std::unique_ptr<GlContext> make_osmesa_context();
std::unique_ptr<GlContext> make_egl_context();

/// @param choice  "osmesa", "egl", or empty: the environment's TUMBLE_GL, else OSMesa, else EGL
///   with a line on stderr
/// @throws UserError when the choice is unknown, or nothing works (both reasons)
std::unique_ptr<GlContext> make_gl_context(const std::string& choice = "");

/// Fills the table with `address("gl...")` for each function.
/// @throws UserError with the first missing function
GlFunctions load_gl_functions(void* (*address)(const char* name), const std::string& library);

}  // namespace tumble::render
