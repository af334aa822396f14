// The model as it is now: the base, deformed by what the hands do to it.
layout(location = 2) in vec2 given_texcoord;
layout(location = 3) in vec3 given_tint;
layout(location = 4) in float held; // by masks, which are dark
uniform float scale;   // metres of the stage in a unit
uniform vec3 offset;
out vec2 texcoord;
out vec3 tint;

void main() {
  vec3 x = base_place, n = base_normal;
  deform(x, n);
  draw_at(scale * x + offset, n);
  texcoord = given_texcoord;
  tint = given_tint * mix(1.0, 0.3, held);
}
