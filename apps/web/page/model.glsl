// The model as it is now: the base, deformed by what the hands do to it.
layout(location = 0) in vec3 base_place;
layout(location = 1) in vec3 base_normal;
layout(location = 2) in vec2 given_texcoord;
layout(location = 3) in vec3 given_tint;
layout(location = 4) in float held; // by masks, which are dark
uniform mat4 clip_of_world;
uniform float scale;   // metres of the stage in a unit
uniform vec3 offset;
uniform vec3 shadow;   // the direction to the light, if this draws its shadow; otherwise zero
out vec3 place;
out vec3 normal;
out vec2 texcoord;
out vec3 tint;

void main() {
  vec3 x = base_place, n = base_normal;
  deform(x, n);
  place = scale * x + offset;
  normal = n;
  texcoord = given_texcoord;
  tint = given_tint * mix(1.0, 0.3, held);
  if (shadow.y > 0.0) place -= shadow * (max(place.y, 0.0) / shadow.y);
  gl_Position = clip_of_world * vec4(place, 1.0);
}
