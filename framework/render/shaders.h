/// The vertex and fragment shaders (GLSL 3.30). Internal to framework/render: included by
/// painter.cpp only.
#pragma once

#include <string>

namespace tumble::render {

// Colours are computed, and the samples of a pixel averaged, in linear light. Opaque surfaces apply
// the sRGB curve themselves, once per pixel; blended ones leave it to the framebuffer, which
// applies it to every sample. In software rendering that takes as long as everything else.
inline const std::string kStored = R"(
vec3 stored(vec3 light) {   // IEC 61966-2-1
  light = max(light, 0.0);
  return mix(12.92 * light, 1.055 * pow(light, vec3(1.0 / 2.4)) - 0.055, step(0.0031308, light));
}
)";

inline constexpr const char* kBodyVertex = R"(#version 330 core
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec4 row0;
layout(location = 3) in vec4 row1;
layout(location = 4) in vec4 row2;
layout(location = 5) in vec4 color;
layout(location = 6) in float quartered;
uniform mat4 clip_from_world;
out vec3 at_world;
out vec3 normal_world;
out vec3 at_local;
flat out vec4 body_color;
flat out float body_quartered;
void main() {
  vec4 p = vec4(position, 1.0);
  at_world = vec3(dot(row0, p), dot(row1, p), dot(row2, p));
  // Normals transform by the inverse transpose; for rotation times scale these are the columns
  // divided by their squared length.
  mat3 m = transpose(mat3(row0.xyz, row1.xyz, row2.xyz));
  vec3 squared = vec3(dot(m[0], m[0]), dot(m[1], m[1]), dot(m[2], m[2]));
  normal_world = m * (normal / squared);
  at_local = position;
  body_color = color;
  body_quartered = quartered;
  gl_Position = clip_from_world * vec4(at_world, 1.0);
}
)";

inline constexpr const char* kDepthVertex = R"(#version 330 core
layout(location = 0) in vec3 position;
layout(location = 2) in vec4 row0;
layout(location = 3) in vec4 row1;
layout(location = 4) in vec4 row2;
uniform mat4 clip_from_world;
void main() {
  vec4 p = vec4(position, 1.0);
  gl_Position = clip_from_world * vec4(dot(row0, p), dot(row1, p), dot(row2, p), 1.0);
}
)";

inline constexpr const char* kDepthFragment = R"(#version 330 core
void main() {}
)";

// Fraction of the key light that arrives: nine shadow-map comparisons, each interpolated between
// four texels by the hardware filter. Where the centre and the corners agree, which is nearly
// everywhere, the four sides are skipped.
inline const std::string kLightShare = R"(
uniform sampler2DShadow shadow_map;
uniform mat4 shadow_from_world;
uniform float shadow_texel;
float lit(vec3 s, float i, float j) {
  return textureLod(shadow_map, s + vec3(1.4 * shadow_texel * vec2(i, j), 0.0), 0.0);
}
float light_share(vec3 p) {
  vec3 s = (shadow_from_world * vec4(p, 1.0)).xyz * 0.5 + 0.5;
  if (any(lessThan(s.xy, vec2(0.0))) || any(greaterThan(s.xy, vec2(1.0)))) return 1.0;
  // Points beyond the range of the map along the light, such as the ground, receive shadow too.
  s.z = clamp(s.z, 0.0, 1.0);
  float corners = lit(s, 0.0, 0.0) + lit(s, -1.0, -1.0) + lit(s, 1.0, -1.0) +
                  lit(s, -1.0, 1.0) + lit(s, 1.0, 1.0);
  // A loop, because software rendering runs both branches of an "if" for all pixels.
  int asked = corners > 0.0 && corners < 5.0 ? 4 : 0;
  float sides = 0.0;
  for (int k = 0; k < asked; ++k)
    sides += lit(s, k == 0 ? -1.0 : k == 1 ? 1.0 : 0.0, k == 2 ? -1.0 : k == 3 ? 1.0 : 0.0);
  return asked == 0 ? corners / 5.0 : (corners + sides) / 9.0;
}
)";

inline const std::string kBodyFragment = std::string(R"(#version 330 core
in vec3 at_world;
in vec3 normal_world;
in vec3 at_local;
flat in vec4 body_color;
flat in float body_quartered;
uniform vec3 eye;
uniform vec3 to_light;
uniform vec3 to_fill;
uniform float shadow_bias;
uniform float is_blended;
out vec4 pixel;
)") + kStored + kLightShare + R"(
void main() {
  vec3 n = normalize(normal_world);
  vec3 v = normalize(eye - at_world);
  if (dot(n, v) < 0.0 && !gl_FrontFacing) n = -n;
  vec3 base = body_color.rgb;
  if (body_quartered > 0.5) {
    float side = at_local.x * at_local.y;
    float blur = max(fwidth(side), 1e-5);
    base = mix(base, mix(base * 0.42, vec3(1.0), 0.06), smoothstep(-blur, blur, side));
  }
  float facing = dot(n, to_light);
  float key = facing > 0.0 ? facing * light_share(at_world + shadow_bias * n) : 0.0;
  float fill = max(dot(n, to_fill), 0.0);
  // ground below, sky above
  vec3 ambient = mix(vec3(0.20, 0.19, 0.18), vec3(0.30, 0.32, 0.35), n.z * 0.5 + 0.5);
  vec3 light = ambient + vec3(0.74, 0.72, 0.68) * key + vec3(0.10, 0.115, 0.14) * fill;
  float gloss = 0.0;
  if (key > 0.0)
    gloss = 0.22 * pow(max(dot(n, normalize(to_light + v)), 0.0), 48.0) * min(1.0, key * 3.0);
  float rim = pow(1.0 - max(dot(n, v), 0.0), 3.0);
  // Glass is more opaque at grazing angles, so that its edges are visible.
  float opacity = body_color.a < 1.0 ? mix(body_color.a, min(1.0, body_color.a * 2.5), rim) : 1.0;
  vec3 seen = base * light + vec3(gloss);
  pixel = vec4(is_blended > 0.5 ? seen : stored(seen), opacity);
}
)";

inline constexpr const char* kMarkFragment = R"(#version 330 core
in vec3 at_world;
in vec3 normal_world;
in vec3 at_local;
flat in vec4 body_color;
flat in float body_quartered;
uniform vec3 eye;
out vec4 pixel;
void main() {
  float facing = abs(dot(normalize(normal_world), normalize(eye - at_world)));
  pixel = vec4(body_color.rgb * mix(0.62, 1.0, facing), body_color.a);
}
)";

// One triangle over the whole picture, just before the far plane: visible where nothing else is.
inline constexpr const char* kBackdropVertex = R"(#version 330 core
out vec2 place;
void main() {
  vec2 corner = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
  place = corner;
  gl_Position = vec4(corner, 0.999999, 1.0);
}
)";

// The sky behind everything. @param place  coordinates of the pixel, -1 to 1 across the picture
inline const std::string kSky = R"(
uniform vec3 low;
uniform vec3 high;
vec3 sky(vec2 place) {
  float t = smoothstep(-1.0, 1.0, place.y);
  float corner = 1.0 - 0.07 * dot(place, place);
  return mix(low, high, t) * corner;
}
)";

inline const std::string kBackdropFragment = std::string(R"(#version 330 core
in vec2 place;
out vec4 pixel;
)") + kStored + kSky + R"(
void main() { pixel = vec4(stored(sky(place)), 1.0); }
)";

inline constexpr const char* kGroundVertex = R"(#version 330 core
uniform mat4 clip_from_world;
uniform vec3 centre;
uniform float reach;
out vec3 at_world;
void main() {
  vec2 corner = vec2(gl_VertexID == 1 || gl_VertexID == 2 || gl_VertexID == 4 ? 1.0 : -1.0,
                     gl_VertexID >= 2 && gl_VertexID != 3 ? 1.0 : -1.0);
  at_world = centre + vec3(reach * corner, 0.0);
  gl_Position = clip_from_world * vec4(at_world, 1.0);
}
)";

// The ground: a light plane with shadows and a grid. Lines are at least a pixel wide, and fade
// where they would be closer than a few pixels. Every fifth line is stronger.
inline const std::string kGroundFragment = std::string(R"(#version 330 core
in vec3 at_world;
uniform vec3 centre;
uniform float reach;
uniform float spacing;
uniform vec3 picture;
out vec4 pixel;
)") + kStored + kLightShare + kSky + R"(
float lines(vec2 p, float step, float width) {
  vec2 q = p / step;
  vec2 blur = max(fwidth(q), vec2(1e-6));
  vec2 away = abs(fract(q - 0.5) - 0.5) / blur;
  vec2 line = clamp(width * 0.5 + 0.5 - away, 0.0, 1.0) * clamp(0.5 / blur - 1.0, 0.0, 1.0);
  return max(line.x, line.y);
}
void main() {
  float fade = 1.0 - smoothstep(0.35, 1.0, length(at_world.xy - centre.xy) / reach);
  vec3 color = vec3(0.80, 0.81, 0.81);
  if (spacing > 0.0) {
    float line = max(0.50 * lines(at_world.xy, spacing, 1.0),
                     0.85 * lines(at_world.xy, 5.0 * spacing, 1.5));
    color = mix(color, vec3(0.36, 0.42, 0.48), line);
  }
  color *= mix(0.36, 1.0, light_share(at_world));
  // It fades into the sky, mixed here: blending a whole picture costs more than drawing it.
  pixel = vec4(stored(mix(sky(2.0 * gl_FragCoord.xy / picture.xy - 1.0), color, fade)), 1.0);
}
)";

}  // namespace tumble::render
