// OpenGL without a screen, by EGL's surfaceless platform: for machines whose Mesa has dropped
// OSMesa.
#include <dlfcn.h>

#include <EGL/egl.h>
#include <EGL/eglext.h>

#include "framework/core/error.h"
#include "framework/render/gl_context.h"

namespace tumble::render {
namespace {

constexpr const char* kLibrary = "libEGL.so.1";
constexpr const char* kRemedy = "Install the packages libegl1 and libgl1-mesa-dri.";

struct Library {
  decltype(&eglGetProcAddress) address;
  decltype(&eglInitialize) initialize;
  decltype(&eglBindAPI) bind_api;
  decltype(&eglChooseConfig) choose_config;
  decltype(&eglCreateContext) create_context;
  decltype(&eglDestroyContext) destroy_context;
  decltype(&eglMakeCurrent) make_current;
  EGLDisplay display;
};

Library open_library() {
  void* handle = dlopen(kLibrary, RTLD_NOW | RTLD_LOCAL);
  if (handle == nullptr) throw UserError(kLibrary, "cannot be opened", kRemedy);
  const auto find = [&]<class Function>(Function& function, const char* name) {
    function = reinterpret_cast<Function>(dlsym(handle, name));
    if (function == nullptr) throw UserError(kLibrary, std::string("has no ") + name, kRemedy);
  };
  Library found{};
  find(found.address, "eglGetProcAddress");
  find(found.initialize, "eglInitialize");
  find(found.bind_api, "eglBindAPI");
  find(found.choose_config, "eglChooseConfig");
  find(found.create_context, "eglCreateContext");
  find(found.destroy_context, "eglDestroyContext");
  find(found.make_current, "eglMakeCurrent");
  const auto platform_display =
      reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(found.address("eglGetPlatformDisplayEXT"));
  if (platform_display == nullptr)
    throw UserError(kLibrary, "offers no platform displays", kRemedy);
  found.display = platform_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
  if (found.display == EGL_NO_DISPLAY || !found.initialize(found.display, nullptr, nullptr))
    throw UserError(kLibrary, "offers no surfaceless display", kRemedy);
  return found;
}

// Opened once and never closed, like OSMesa's.
const Library& library() {
  static const Library opened = open_library();
  return opened;
}

class EglContext final : public GlContext {
 public:
  EglContext() {
    const EGLint wanted[] = {EGL_SURFACE_TYPE, 0, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
    const EGLint version[] = {EGL_CONTEXT_MAJOR_VERSION,
                              3,
                              EGL_CONTEXT_MINOR_VERSION,
                              3,
                              EGL_CONTEXT_OPENGL_PROFILE_MASK,
                              EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                              EGL_NONE};
    EGLConfig config = nullptr;
    EGLint count = 0;
    if (library().bind_api(EGL_OPENGL_API) &&
        library().choose_config(library().display, wanted, &config, 1, &count) && count > 0)
      context_ = library().create_context(library().display, config, EGL_NO_CONTEXT, version);
    if (context_ == EGL_NO_CONTEXT)
      throw UserError(kLibrary, "offers no OpenGL 3.3 core context", kRemedy);
    const Current current(*this);
    gl_ = load_gl_functions(
        [](const char* name) { return reinterpret_cast<void*>(library().address(name)); },
        kLibrary);
  }
  ~EglContext() override { library().destroy_context(library().display, context_); }

  void make_current() override {
    library().bind_api(EGL_OPENGL_API);
    if (!library().make_current(library().display, EGL_NO_SURFACE, EGL_NO_SURFACE, context_))
      throw UserError(kLibrary, "cannot make its context current");
  }
  void release() override {
    library().make_current(library().display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  }
  const char* name() const override { return "egl"; }

 private:
  EGLContext context_ = EGL_NO_CONTEXT;
};

}  // namespace

std::unique_ptr<GlContext> make_egl_context() { return std::make_unique<EglContext>(); }

}  // namespace tumble::render
