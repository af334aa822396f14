// Where a vertex is drawn, or its shadow on the ground.
uniform mat4 clip_of_world;
uniform vec3 shadow; // the direction to the light, if this draws its shadow; otherwise zero
out vec3 place;
out vec3 normal;

void draw_at(vec3 at, vec3 outwards) {
  place = shadow.y > 0.0 ? at - shadow * (max(at.y, 0.0) / shadow.y) : at;
  normal = outwards;
  gl_Position = clip_of_world * vec4(place, 1.0);
}
