/// The part of OpenGL 3.3 core that pictures need, as a table of function pointers. Internal to
/// framework/render.
///
/// No gl* symbol is linked, because a program linked with both libGL and libOSMesa draws black
/// pictures (the loader's stubs take precedence over Mesa's functions). No GL header is included:
/// the scalar types here are those of the GL binary interface, and osmesa_context.cpp checks the
/// constants against Mesa's header.
#pragma once

#include <cstddef>

namespace tumble::render {

using GlEnum = unsigned int;
using GlName = unsigned int;  // of a buffer, texture, shader, ...

// F(return type, name without "gl", parameters)
#define TUMBLE_GL_FUNCTIONS(F)                                                           \
  F(void, ActiveTexture, (GlEnum))                                                       \
  F(void, AttachShader, (GlName, GlName))                                                \
  F(void, BindBuffer, (GlEnum, GlName))                                                  \
  F(void, BindFramebuffer, (GlEnum, GlName))                                             \
  F(void, BindRenderbuffer, (GlEnum, GlName))                                            \
  F(void, BindTexture, (GlEnum, GlName))                                                 \
  F(void, BindVertexArray, (GlName))                                                     \
  F(void, BlendFuncSeparate, (GlEnum, GlEnum, GlEnum, GlEnum))                           \
  F(void, BlitFramebuffer, (int, int, int, int, int, int, int, int, unsigned, GlEnum))   \
  F(void, BufferData, (GlEnum, std::ptrdiff_t, const void*, GlEnum))                     \
  F(GlEnum, CheckFramebufferStatus, (GlEnum))                                            \
  F(void, Clear, (unsigned))                                                             \
  F(void, CompileShader, (GlName))                                                       \
  F(GlName, CreateProgram, ())                                                           \
  F(GlName, CreateShader, (GlEnum))                                                      \
  F(void, CullFace, (GlEnum))                                                            \
  F(void, DepthMask, (unsigned char))                                                    \
  F(void, Disable, (GlEnum))                                                             \
  F(void, DrawArrays, (GlEnum, int, int))                                                \
  F(void, DrawBuffer, (GlEnum))                                                          \
  F(void, DrawElementsInstanced, (GlEnum, int, GlEnum, const void*, int))                \
  F(void, Enable, (GlEnum))                                                              \
  F(void, EnableVertexAttribArray, (unsigned))                                           \
  F(void, FramebufferRenderbuffer, (GlEnum, GlEnum, GlEnum, GlName))                     \
  F(void, FramebufferTexture2D, (GlEnum, GlEnum, GlEnum, GlName, int))                   \
  F(void, GenBuffers, (int, GlName*))                                                    \
  F(void, GenFramebuffers, (int, GlName*))                                               \
  F(void, GenRenderbuffers, (int, GlName*))                                              \
  F(void, GenTextures, (int, GlName*))                                                   \
  F(void, GenVertexArrays, (int, GlName*))                                               \
  F(GlEnum, GetError, ())                                                                \
  F(void, GetProgramInfoLog, (GlName, int, int*, char*))                                 \
  F(void, GetProgramiv, (GlName, GlEnum, int*))                                          \
  F(void, GetShaderInfoLog, (GlName, int, int*, char*))                                  \
  F(void, GetShaderiv, (GlName, GlEnum, int*))                                           \
  F(const unsigned char*, GetString, (GlEnum))                                           \
  F(int, GetUniformLocation, (GlName, const char*))                                      \
  F(void, LinkProgram, (GlName))                                                         \
  F(void, PixelStorei, (GlEnum, int))                                                    \
  F(void, PolygonOffset, (float, float))                                                 \
  F(void, ReadBuffer, (GlEnum))                                                          \
  F(void, ReadPixels, (int, int, int, int, GlEnum, GlEnum, void*))                       \
  F(void, RenderbufferStorageMultisample, (GlEnum, int, GlEnum, int, int))               \
  F(void, ShaderSource, (GlName, int, const char* const*, const int*))                   \
  F(void, TexImage2D, (GlEnum, int, int, int, int, int, GlEnum, GlEnum, const void*))    \
  F(void, TexParameteri, (GlEnum, GlEnum, int))                                          \
  F(void, Uniform1f, (int, float))                                                       \
  F(void, Uniform1i, (int, int))                                                         \
  F(void, Uniform3fv, (int, int, const float*))                                          \
  F(void, Uniform4fv, (int, int, const float*))                                          \
  F(void, UniformMatrix4fv, (int, int, unsigned char, const float*))                     \
  F(void, UseProgram, (GlName))                                                          \
  F(void, VertexAttribDivisor, (unsigned, unsigned))                                     \
  F(void, VertexAttribPointer, (unsigned, int, GlEnum, unsigned char, int, const void*)) \
  F(void, Viewport, (int, int, int, int))

struct GlFunctions {
#define TUMBLE_GL_FIELD(RESULT, NAME, PARAMETERS) RESULT(*NAME) PARAMETERS = nullptr;
  TUMBLE_GL_FUNCTIONS(TUMBLE_GL_FIELD)
#undef TUMBLE_GL_FIELD
};

// C(name here, name in GL's headers, value)
#define TUMBLE_GL_CONSTANTS(C)                               \
  C(kArrayBuffer, GL_ARRAY_BUFFER, 0x8892)                   \
  C(kBack, GL_BACK, 0x0405)                                  \
  C(kBlend, GL_BLEND, 0x0BE2)                                \
  C(kClampToEdge, GL_CLAMP_TO_EDGE, 0x812F)                  \
  C(kColorAttachment, GL_COLOR_ATTACHMENT0, 0x8CE0)          \
  C(kColorBufferBit, GL_COLOR_BUFFER_BIT, 0x4000)            \
  C(kCompareRefToTexture, GL_COMPARE_REF_TO_TEXTURE, 0x884E) \
  C(kCompileStatus, GL_COMPILE_STATUS, 0x8B81)               \
  C(kCullFace, GL_CULL_FACE, 0x0B44)                         \
  C(kDepthAttachment, GL_DEPTH_ATTACHMENT, 0x8D00)           \
  C(kDepthBufferBit, GL_DEPTH_BUFFER_BIT, 0x0100)            \
  C(kDepthComponent, GL_DEPTH_COMPONENT, 0x1902)             \
  C(kDepthComponent24, GL_DEPTH_COMPONENT24, 0x81A6)         \
  C(kDepthComponent32F, GL_DEPTH_COMPONENT32F, 0x8CAC)       \
  C(kDepthTest, GL_DEPTH_TEST, 0x0B71)                       \
  C(kDrawFramebuffer, GL_DRAW_FRAMEBUFFER, 0x8CA9)           \
  C(kDynamicDraw, GL_DYNAMIC_DRAW, 0x88E8)                   \
  C(kElementArrayBuffer, GL_ELEMENT_ARRAY_BUFFER, 0x8893)    \
  C(kFloat, GL_FLOAT, 0x1406)                                \
  C(kFragmentShader, GL_FRAGMENT_SHADER, 0x8B30)             \
  C(kFramebuffer, GL_FRAMEBUFFER, 0x8D40)                    \
  C(kFramebufferComplete, GL_FRAMEBUFFER_COMPLETE, 0x8CD5)   \
  C(kFramebufferSrgb, GL_FRAMEBUFFER_SRGB, 0x8DB9)           \
  C(kFront, GL_FRONT, 0x0404)                                \
  C(kLinear, GL_LINEAR, 0x2601)                              \
  C(kLinkStatus, GL_LINK_STATUS, 0x8B82)                     \
  C(kMultisample, GL_MULTISAMPLE, 0x809D)                    \
  C(kNearest, GL_NEAREST, 0x2600)                            \
  C(kOne, GL_ONE, 1)                                         \
  C(kOneMinusSrcAlpha, GL_ONE_MINUS_SRC_ALPHA, 0x0303)       \
  C(kPackAlignment, GL_PACK_ALIGNMENT, 0x0D05)               \
  C(kPolygonOffsetFill, GL_POLYGON_OFFSET_FILL, 0x8037)      \
  C(kReadFramebuffer, GL_READ_FRAMEBUFFER, 0x8CA8)           \
  C(kRenderbuffer, GL_RENDERBUFFER, 0x8D41)                  \
  C(kRgb, GL_RGB, 0x1907)                                    \
  C(kRgba, GL_RGBA, 0x1908)                                  \
  C(kSrcAlpha, GL_SRC_ALPHA, 0x0302)                         \
  C(kSrgb8Alpha8, GL_SRGB8_ALPHA8, 0x8C43)                   \
  C(kStaticDraw, GL_STATIC_DRAW, 0x88E4)                     \
  C(kTexture0, GL_TEXTURE0, 0x84C0)                          \
  C(kTexture2D, GL_TEXTURE_2D, 0x0DE1)                       \
  C(kTextureCompareMode, GL_TEXTURE_COMPARE_MODE, 0x884C)    \
  C(kTextureMagFilter, GL_TEXTURE_MAG_FILTER, 0x2800)        \
  C(kTextureMinFilter, GL_TEXTURE_MIN_FILTER, 0x2801)        \
  C(kTextureWrapS, GL_TEXTURE_WRAP_S, 0x2802)                \
  C(kTextureWrapT, GL_TEXTURE_WRAP_T, 0x2803)                \
  C(kTriangles, GL_TRIANGLES, 0x0004)                        \
  C(kUnsignedByte, GL_UNSIGNED_BYTE, 0x1401)                 \
  C(kUnsignedInt, GL_UNSIGNED_INT, 0x1405)                   \
  C(kVersion, GL_VERSION, 0x1F02)                            \
  C(kVertexShader, GL_VERTEX_SHADER, 0x8B31)

namespace gl {
#define TUMBLE_GL_VALUE(NAME, GL_NAME, VALUE) inline constexpr GlEnum NAME = VALUE;
TUMBLE_GL_CONSTANTS(TUMBLE_GL_VALUE)
#undef TUMBLE_GL_VALUE
}  // namespace gl

}  // namespace tumble::render
