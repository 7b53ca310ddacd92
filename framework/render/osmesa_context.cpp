// OpenGL in memory, by Mesa's off-screen library.
#include <dlfcn.h>

#include <mutex>

#include <GL/osmesa.h>

#include "framework/core/error.h"
#include "framework/render/gl_context.h"

namespace tumble::render {
namespace {

#define TUMBLE_GL_CHECK(NAME, GL_NAME, VALUE) static_assert(gl::NAME == GL_NAME);
TUMBLE_GL_CONSTANTS(TUMBLE_GL_CHECK)
#undef TUMBLE_GL_CHECK

constexpr const char* kLibrary = "libOSMesa.so.8";

struct Library {
  decltype(&OSMesaCreateContextAttribs) create;
  decltype(&OSMesaDestroyContext) destroy;
  decltype(&OSMesaMakeCurrent) make_current;
  decltype(&OSMesaGetProcAddress) address;
};

// Opened once and never closed: Mesa leaves threads and exit handlers behind.
const Library& library() {
  static const Library opened = [] {
    void* handle = dlopen(kLibrary, RTLD_NOW | RTLD_LOCAL);
    if (handle == nullptr)
      throw UserError(kLibrary, "cannot be opened", "Install the package libosmesa6.");
    const auto find = [&]<class Function>(Function& function, const char* name) {
      function = reinterpret_cast<Function>(dlsym(handle, name));
      if (function == nullptr)
        throw UserError(kLibrary, std::string("has no ") + name, "Install the package libosmesa6.");
    };
    Library found{};
    find(found.create, "OSMesaCreateContextAttribs");
    find(found.destroy, "OSMesaDestroyContext");
    find(found.make_current, "OSMesaMakeCurrent");
    find(found.address, "OSMesaGetProcAddress");
    return found;
  }();
  return opened;
}

// Threads may draw at the same time, each with a context of its own; OSMesa does not say that they
// may also create, bind and destroy contexts at the same time, so they take turns in that.
std::mutex& one_at_a_time() {
  static std::mutex mutex;
  return mutex;
}

class OsmesaContext final : public GlContext {
 public:
  OsmesaContext() {
    const int wanted[] = {OSMESA_FORMAT,
                          OSMESA_RGBA,
                          OSMESA_PROFILE,
                          OSMESA_CORE_PROFILE,
                          OSMESA_CONTEXT_MAJOR_VERSION,
                          3,
                          OSMESA_CONTEXT_MINOR_VERSION,
                          3,
                          0};
    {
      const std::lock_guard lock(one_at_a_time());
      context_ = library().create(wanted, nullptr);
    }
    if (context_ == nullptr)
      throw UserError(kLibrary, "offers no OpenGL 3.3 core context",
                      "Install Debian 12's libosmesa6.");
    const Current current(*this);
    gl_ = load_gl_functions(
        [](const char* name) { return reinterpret_cast<void*>(library().address(name)); },
        kLibrary);
  }
  ~OsmesaContext() override {
    const std::lock_guard lock(one_at_a_time());
    library().destroy(context_);
  }

  void make_current() override {
    const std::lock_guard lock(one_at_a_time());
    if (!library().make_current(context_, own_buffer_, GL_UNSIGNED_BYTE, kSide, kSide))
      throw UserError(kLibrary, "cannot make its context current");
  }
  void release() override {
    const std::lock_guard lock(one_at_a_time());
    library().make_current(nullptr, nullptr, 0, 0, 0);
  }
  const char* name() const override { return "osmesa"; }

 private:
  // pixels: a buffer that OSMesa requires; nothing is drawn into it
  static constexpr int kSide = 4;
  OSMesaContext context_ = nullptr;
  unsigned char own_buffer_[4 * kSide * kSide] = {};
};

}  // namespace

std::unique_ptr<GlContext> make_osmesa_context() { return std::make_unique<OsmesaContext>(); }

}  // namespace tumble::render
