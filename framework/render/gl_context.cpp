#include "framework/render/gl_context.h"

#include <atomic>
#include <cstdio>
#include <cstdlib>

#include "framework/core/error.h"

namespace tumble::render {

GlFunctions load_gl_functions(void* (*address)(const char*), const std::string& library) {
  GlFunctions table;
  const auto fill = [&](auto& field, const char* name) {
    field = reinterpret_cast<std::remove_reference_t<decltype(field)>>(address(name));
    if (field == nullptr)
      throw UserError(library, std::string("does not offer ") + name,
                      "Pictures need OpenGL 3.3 core.");
  };
#define TUMBLE_GL_FILL(RESULT, NAME, PARAMETERS) fill(table.NAME, "gl" #NAME);
  TUMBLE_GL_FUNCTIONS(TUMBLE_GL_FILL)
#undef TUMBLE_GL_FILL
  return table;
}

std::unique_ptr<GlContext> make_gl_context(const std::string& choice) {
  const char* environment = std::getenv("TUMBLE_GL");
  const std::string wanted = !choice.empty() ? choice : environment != nullptr ? environment : "";
  if (wanted == "osmesa") return make_osmesa_context();
  if (wanted == "egl") return make_egl_context();
  if (!wanted.empty())
    throw UserError(choice.empty() ? "TUMBLE_GL" : "--gl", "\"" + wanted + "\" is not known",
                    "Choose osmesa or egl.");
  try {
    return make_osmesa_context();
  } catch (const UserError& no_osmesa) {
    try {
      auto context = make_egl_context();
      static std::atomic_flag is_told;
      if (!is_told.test_and_set())
        std::fprintf(stderr, "tumble: drawing with EGL, because %s\n", no_osmesa.what());
      return context;
    } catch (const UserError& no_egl) {
      throw UserError("pictures",
                      std::string("neither OSMesa nor EGL works here: ") + no_osmesa.what() + "; " +
                          no_egl.what(),
                      "Install libosmesa6, or libegl1 with libgl1-mesa-dri.");
    }
  }
}

}  // namespace tumble::render
