#include "framework/render/painter.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <string>

#include "framework/core/error.h"
#include "framework/render/shaders.h"

namespace tumble::render {
namespace {

// texels: one is about a pixel wide where the shadow fills a 640x480 picture
constexpr int kShadowSide = 1024;
using Matrix4f = Eigen::Matrix4f;  // column-major, as OpenGL needs it

// In matrices and shaders the world's origin is the drawing's.
Matrix4f clip_from_world(const Drawing& drawing, double aspect) {
  const View& view = drawing.view;
  const double near_m = drawing.near_m, far_m = drawing.far_m;
  Eigen::Matrix4d camera_from_world = Eigen::Matrix4d::Identity();
  camera_from_world.block<1, 3>(0, 0) = view.right_world.transpose();
  camera_from_world.block<1, 3>(1, 0) = view.up_world.transpose();
  camera_from_world.block<1, 3>(2, 0) = -view.forward_world.transpose();
  camera_from_world.block<3, 1>(0, 3) =
      -camera_from_world.block<3, 3>(0, 0) * drawing.from_origin(view.eye_world);
  Eigen::Matrix4d clip_from_camera = Eigen::Matrix4d::Zero();
  clip_from_camera(0, 0) = 1.0 / (view.tan_half_height * aspect);
  clip_from_camera(1, 1) = 1.0 / view.tan_half_height;
  clip_from_camera(2, 2) = -(far_m + near_m) / (far_m - near_m);
  clip_from_camera(2, 3) = -2.0 * far_m * near_m / (far_m - near_m);
  clip_from_camera(3, 2) = -1.0;
  return (clip_from_camera * camera_from_world).cast<float>();
}

// Parallel light: orthographic projection, along the light, of a cube around the ball of shadows.
Matrix4f shadow_from_world(const Drawing& drawing) {
  const Vector3d z = drawing.to_light_world;
  const Vector3d x = z.unitOrthogonal(), y = z.cross(x);
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  m.block<1, 3>(0, 0) = x.transpose();
  m.block<1, 3>(1, 0) = y.transpose();
  m.block<1, 3>(2, 0) = -z.transpose();
  m.block<3, 3>(0, 0) /= drawing.shadow_radius_m;
  m.block<3, 1>(0, 3) = -m.block<3, 3>(0, 0) * drawing.from_origin(drawing.shadow_centre_world);
  return m.cast<float>();
}

Eigen::Vector3f to_float(const Vector3d& v) { return v.cast<float>(); }

}  // namespace

class Painter::Body {
 public:
  Body(std::unique_ptr<GlContext> context, const std::vector<Geometry>& geometries, int width,
       int height, int samples)
      : context_(std::move(context)), gl_(context_->gl()), width_(width), height_(height) {
    const Current current(*context_);
    bodies_ = link(kBodyVertex, kBodyFragment);
    marks_ = link(kBodyVertex, kMarkFragment);
    depth_ = link(kDepthVertex, kDepthFragment);
    backdrop_ = link(kBackdropVertex, kBackdropFragment);
    ground_ = link(kGroundVertex, kGroundFragment);
    for (const Geometry& geometry : geometries) meshes_.push_back(upload(geometry));
    gl_.GenVertexArrays(1, &no_vertices_);
    canvas_ = make_canvas(samples);
    resolved_ = make_canvas(0);
    make_shadow_map();
    expect_no_error("setting up");
  }

  Image paint(const Drawing& drawing) {
    const Current current(*context_);
    const Matrix4f shadow = shadow_from_world(drawing);
    draw_shadow_map(drawing, shadow);
    gl_.BindFramebuffer(gl::kFramebuffer, canvas_);
    gl_.Viewport(0, 0, width_, height_);
    gl_.Disable(gl::kFramebufferSrgb);  // needed for blending only
    gl_.Clear(gl::kColorBufferBit | gl::kDepthBufferBit);
    const Matrix4f clip = clip_from_world(drawing, static_cast<double>(width_) / height_);
    gl_.Enable(gl::kDepthTest);
    // Surfaces are closed, so back faces are never visible. Blending costs more than lighting here:
    // it is enabled only where needed.
    gl_.Enable(gl::kCullFace);
    gl_.CullFace(gl::kBack);
    draw_bodies(drawing, clip, shadow, Pass::kSolid);
    gl_.Disable(gl::kCullFace);
    // Bodies are drawn first: hidden pixels of the ground and the backdrop are not shaded.
    draw_ground(drawing, clip, shadow);
    draw_backdrop();
    gl_.Enable(gl::kFramebufferSrgb);
    gl_.Enable(gl::kBlend);
    gl_.BlendFuncSeparate(gl::kSrcAlpha, gl::kOneMinusSrcAlpha, gl::kOne, gl::kOneMinusSrcAlpha);
    draw_unlit(drawing, clip, Pass::kLine);
    // Glass occludes nothing: no depth is written, and its back faces are not drawn.
    gl_.DepthMask(0);
    gl_.Enable(gl::kCullFace);
    draw_bodies(drawing, clip, shadow, Pass::kGlass);
    gl_.Disable(gl::kCullFace);
    gl_.Disable(gl::kDepthTest);
    draw_unlit(drawing, clip, Pass::kMark);
    gl_.DepthMask(1);
    gl_.Disable(gl::kBlend);
    return read_back();
  }

  const char* context_name() const { return context_->name(); }

 private:
  struct Mesh {
    GlName vertices = 0;   // vertex array
    GlName instances = 0;  // buffer, refilled for each picture
    int index_count = 0;
  };

  std::string log_of(GlName object, void (*read)(GlName, int, int*, char*)) const {
    std::array<char, 2048> text{};
    read(object, static_cast<int>(text.size()), nullptr, text.data());
    return text.data();
  }

  GlName link(const std::string& vertex_source, const std::string& fragment_source) {
    const GlName program = gl_.CreateProgram();
    const std::pair<GlEnum, const char*> parts[] = {{gl::kVertexShader, vertex_source.c_str()},
                                                    {gl::kFragmentShader, fragment_source.c_str()}};
    for (const auto& [kind, source] : parts) {
      const GlName shader = gl_.CreateShader(kind);
      gl_.ShaderSource(shader, 1, &source, nullptr);
      gl_.CompileShader(shader);
      int fine = 0;
      gl_.GetShaderiv(shader, gl::kCompileStatus, &fine);
      if (fine == 0)
        throw UserError(context_->name(),
                        "refuses a shader: " + log_of(shader, gl_.GetShaderInfoLog),
                        "Pictures need GLSL 3.30.");
      gl_.AttachShader(program, shader);
    }
    gl_.LinkProgram(program);
    int fine = 0;
    gl_.GetProgramiv(program, gl::kLinkStatus, &fine);
    if (fine == 0)
      throw UserError(context_->name(),
                      "cannot link a shader: " + log_of(program, gl_.GetProgramInfoLog),
                      "Pictures need GLSL 3.30.");
    return program;
  }

  // Attributes 0 and 1 are per vertex, 2 to 6 per instance, with the layout of Vertex and Instance.
  Mesh upload(const Geometry& geometry) {
    Mesh mesh;
    mesh.index_count = static_cast<int>(geometry.indices.size());
    GlName buffers[2];
    gl_.GenVertexArrays(1, &mesh.vertices);
    gl_.GenBuffers(2, buffers);
    gl_.GenBuffers(1, &mesh.instances);
    gl_.BindVertexArray(mesh.vertices);
    gl_.BindBuffer(gl::kArrayBuffer, buffers[0]);
    gl_.BufferData(gl::kArrayBuffer,
                   static_cast<std::ptrdiff_t>(geometry.vertices.size() * sizeof(Vertex)),
                   geometry.vertices.data(), gl::kStaticDraw);
    attribute(0, 3, sizeof(Vertex), offsetof(Vertex, position), 0);
    attribute(1, 3, sizeof(Vertex), offsetof(Vertex, normal), 0);
    gl_.BindBuffer(gl::kElementArrayBuffer, buffers[1]);
    gl_.BufferData(gl::kElementArrayBuffer,
                   static_cast<std::ptrdiff_t>(geometry.indices.size() * sizeof(std::uint32_t)),
                   geometry.indices.data(), gl::kStaticDraw);
    gl_.BindBuffer(gl::kArrayBuffer, mesh.instances);
    for (unsigned row = 0; row < 3; ++row)
      attribute(2 + row, 4, sizeof(Instance), 4 * row * sizeof(float), 1);
    attribute(5, 4, sizeof(Instance), offsetof(Instance, color), 1);
    attribute(6, 1, sizeof(Instance), offsetof(Instance, quartered), 1);
    gl_.BindVertexArray(0);
    return mesh;
  }

  void attribute(unsigned place, int components, std::size_t stride, std::size_t offset,
                 unsigned divisor) {
    gl_.EnableVertexAttribArray(place);
    gl_.VertexAttribPointer(place, components, gl::kFloat, 0, static_cast<int>(stride),
                            reinterpret_cast<const void*>(offset));
    gl_.VertexAttribDivisor(place, divisor);
  }

  // @param samples  0: a buffer without multisampling, to resolve into
  GlName make_canvas(int samples) {
    GlName canvas = 0, buffers[2];
    gl_.GenFramebuffers(1, &canvas);
    gl_.GenRenderbuffers(2, buffers);
    gl_.BindFramebuffer(gl::kFramebuffer, canvas);
    const int count = samples > 1 ? samples : 0;
    gl_.BindRenderbuffer(gl::kRenderbuffer, buffers[0]);
    gl_.RenderbufferStorageMultisample(gl::kRenderbuffer, count, gl::kSrgb8Alpha8, width_, height_);
    gl_.FramebufferRenderbuffer(gl::kFramebuffer, gl::kColorAttachment, gl::kRenderbuffer,
                                buffers[0]);
    gl_.BindRenderbuffer(gl::kRenderbuffer, buffers[1]);
    gl_.RenderbufferStorageMultisample(gl::kRenderbuffer, count, gl::kDepthComponent24, width_,
                                       height_);
    gl_.FramebufferRenderbuffer(gl::kFramebuffer, gl::kDepthAttachment, gl::kRenderbuffer,
                                buffers[1]);
    if (gl_.CheckFramebufferStatus(gl::kFramebuffer) != gl::kFramebufferComplete)
      throw UserError(context_->name(),
                      "has no framebuffer of " + std::to_string(width_) + "x" +
                          std::to_string(height_) + " pixels with " + std::to_string(samples) +
                          " samples",
                      "Ask for a smaller picture.");
    return canvas;
  }

  void make_shadow_map() {
    gl_.GenTextures(1, &shadow_map_);
    gl_.ActiveTexture(gl::kTexture0);
    gl_.BindTexture(gl::kTexture2D, shadow_map_);
    gl_.TexImage2D(gl::kTexture2D, 0, gl::kDepthComponent32F, kShadowSide, kShadowSide, 0,
                   gl::kDepthComponent, gl::kFloat, nullptr);
    const std::pair<GlEnum, GlEnum> settings[] = {
        {gl::kTextureMinFilter, gl::kLinear},
        {gl::kTextureMagFilter, gl::kLinear},
        {gl::kTextureWrapS, gl::kClampToEdge},
        {gl::kTextureWrapT, gl::kClampToEdge},
        {gl::kTextureCompareMode, gl::kCompareRefToTexture}};
    for (const auto& [name, value] : settings)
      gl_.TexParameteri(gl::kTexture2D, name, static_cast<int>(value));
    gl_.GenFramebuffers(1, &shadow_canvas_);
    gl_.BindFramebuffer(gl::kFramebuffer, shadow_canvas_);
    gl_.FramebufferTexture2D(gl::kFramebuffer, gl::kDepthAttachment, gl::kTexture2D, shadow_map_,
                             0);
    gl_.DrawBuffer(0);
    gl_.ReadBuffer(0);
  }

  // A geometry may be in several batches, so its instances are uploaded just before they are drawn.
  void draw(const Batch& batch) {
    require(batch.geometry >= 0 && batch.geometry < static_cast<int>(meshes_.size()),
            "painter: a batch without a known geometry");
    if (batch.instances.empty()) return;
    const Mesh& mesh = meshes_[static_cast<std::size_t>(batch.geometry)];
    gl_.BindBuffer(gl::kArrayBuffer, mesh.instances);
    gl_.BufferData(gl::kArrayBuffer,
                   static_cast<std::ptrdiff_t>(batch.instances.size() * sizeof(Instance)),
                   batch.instances.data(), gl::kDynamicDraw);
    gl_.BindVertexArray(mesh.vertices);
    gl_.DrawElementsInstanced(gl::kTriangles, mesh.index_count, gl::kUnsignedInt, nullptr,
                              static_cast<int>(batch.instances.size()));
  }

  void draw_shadow_map(const Drawing& drawing, const Matrix4f& shadow) {
    gl_.BindFramebuffer(gl::kFramebuffer, shadow_canvas_);
    gl_.Viewport(0, 0, kShadowSide, kShadowSide);
    gl_.Clear(gl::kDepthBufferBit);
    gl_.Enable(gl::kDepthTest);
    gl_.Enable(gl::kPolygonOffsetFill);
    gl_.PolygonOffset(2.0f, 4.0f);
    gl_.Enable(gl::kCullFace);  // of a closed surface only the faces towards the light are needed
    gl_.CullFace(gl::kBack);
    gl_.UseProgram(depth_);
    uniform(depth_, "clip_from_world", shadow);
    for (const Batch& batch : drawing.batches)
      if (batch.pass == Pass::kSolid) draw(batch);
    gl_.Disable(gl::kCullFace);
    gl_.Disable(gl::kPolygonOffsetFill);
  }

  void draw_backdrop() {
    gl_.UseProgram(backdrop_);
    use_sky(backdrop_);
    gl_.BindVertexArray(no_vertices_);
    gl_.DrawArrays(gl::kTriangles, 0, 3);
  }

  void draw_ground(const Drawing& drawing, const Matrix4f& clip, const Matrix4f& shadow) {
    if (!drawing.ground.shown) return;
    gl_.UseProgram(ground_);
    uniform(ground_, "clip_from_world", clip);
    use_shadow(ground_, shadow);
    const Ground& ground = drawing.ground;
    uniform(
        ground_, "centre",
        to_float(drawing.from_origin({ground.centre_m.x(), ground.centre_m.y(), ground.height_m})));
    uniform(ground_, "reach", static_cast<float>(ground.fade_m));
    uniform(ground_, "spacing", static_cast<float>(ground.spacing_m));
    uniform(ground_, "picture",
            Eigen::Vector3f(static_cast<float>(width_), static_cast<float>(height_), 0.0f));
    use_sky(ground_);
    gl_.BindVertexArray(no_vertices_);
    gl_.DrawArrays(gl::kTriangles, 0, 6);
  }

  void draw_bodies(const Drawing& drawing, const Matrix4f& clip, const Matrix4f& shadow,
                   Pass pass) {
    gl_.UseProgram(bodies_);
    uniform(bodies_, "clip_from_world", clip);
    use_shadow(bodies_, shadow);
    const View& view = drawing.view;
    uniform(bodies_, "eye", to_float(drawing.from_origin(view.eye_world)));
    uniform(bodies_, "to_light", to_float(drawing.to_light_world));
    uniform(bodies_, "to_fill",
            to_float((view.right_world * 0.8 - view.forward_world * 0.6 + view.up_world * 0.1)
                         .normalized()));
    uniform(bodies_, "is_blended", pass == Pass::kGlass ? 1.0f : 0.0f);
    uniform(bodies_, "shadow_bias",
            static_cast<float>(2.0 * drawing.shadow_radius_m / kShadowSide));
    for (const Batch& batch : drawing.batches)
      if (batch.pass == pass) draw(batch);
  }

  void draw_unlit(const Drawing& drawing, const Matrix4f& clip, Pass pass) {
    gl_.UseProgram(marks_);
    uniform(marks_, "clip_from_world", clip);
    uniform(marks_, "eye", to_float(drawing.from_origin(drawing.view.eye_world)));
    for (const Batch& batch : drawing.batches)
      if (batch.pass == pass) draw(batch);
  }

  void use_sky(GlName program) {
    uniform(program, "low", Eigen::Vector3f(0.86f, 0.875f, 0.885f));
    uniform(program, "high", Eigen::Vector3f(0.52f, 0.63f, 0.74f));
  }

  void use_shadow(GlName program, const Matrix4f& shadow) {
    gl_.Uniform1i(gl_.GetUniformLocation(program, "shadow_map"), 0);
    uniform(program, "shadow_from_world", shadow);
    uniform(program, "shadow_texel", 1.0f / kShadowSide);
  }

  void uniform(GlName program, const char* name, const Matrix4f& m) {
    gl_.UniformMatrix4fv(gl_.GetUniformLocation(program, name), 1, 0, m.data());
  }
  void uniform(GlName program, const char* name, const Eigen::Vector3f& v) {
    gl_.Uniform3fv(gl_.GetUniformLocation(program, name), 1, v.data());
  }
  void uniform(GlName program, const char* name, float x) {
    gl_.Uniform1f(gl_.GetUniformLocation(program, name), x);
  }

  // OpenGL stores rows from the bottom, an image from the top.
  Image read_back() {
    gl_.BindFramebuffer(gl::kReadFramebuffer, canvas_);
    gl_.BindFramebuffer(gl::kDrawFramebuffer, resolved_);
    gl_.BlitFramebuffer(0, 0, width_, height_, 0, 0, width_, height_, gl::kColorBufferBit,
                        gl::kNearest);
    gl_.BindFramebuffer(gl::kFramebuffer, resolved_);
    gl_.PixelStorei(gl::kPackAlignment, 1);
    rgba_.resize(static_cast<std::size_t>(width_) * height_ * 4);
    gl_.ReadPixels(0, 0, width_, height_, gl::kRgba, gl::kUnsignedByte, rgba_.data());
    expect_no_error("drawing");
    Image image(width_, height_);
    for (int y = 0; y < height_; ++y) {
      const std::uint8_t* from = &rgba_[static_cast<std::size_t>(height_ - 1 - y) * width_ * 4];
      std::uint8_t* to = image.pixel(0, y);
      for (int x = 0; x < width_; ++x, from += 4, to += 3) std::memcpy(to, from, 3);
    }
    return image;
  }

  void expect_no_error(const char* doing) {
    if (const GlEnum code = gl_.GetError(); code != 0)
      throw std::logic_error(std::string("OpenGL error ") + std::to_string(code) + " while " +
                             doing + " (" + context_->name() + ")");
  }

  std::unique_ptr<GlContext> context_;
  const GlFunctions& gl_;
  int width_, height_;
  GlName bodies_ = 0, marks_ = 0, depth_ = 0, backdrop_ = 0, ground_ = 0;  // programs
  GlName canvas_ = 0, resolved_ = 0, shadow_canvas_ = 0, shadow_map_ = 0, no_vertices_ = 0;
  std::vector<Mesh> meshes_;
  std::vector<std::uint8_t> rgba_;
};

Painter::Painter(std::unique_ptr<GlContext> context, const std::vector<Geometry>& geometries,
                 int width, int height, int samples)
    : body_(std::make_unique<Body>(std::move(context), geometries, width, height, samples)) {}
Painter::~Painter() = default;
Painter::Painter(Painter&&) noexcept = default;

Image Painter::paint(const Drawing& drawing) { return body_->paint(drawing); }
const char* Painter::context_name() const { return body_->context_name(); }

}  // namespace tumble::render
