// The normals of a shape: the sums of those of the triangles about each vertex, weighted by area.
layout(location = 5) in uvec2 own_round;  // the first triangle about it, and how many
uniform highp sampler2D places;           // of all vertices
uniform highp usampler2D round;           // each triangle's other two corners
out vec3 moved_normal;

vec3 place_of(uint vertex) { return texelFetch(places, ivec2(int(vertex & 2047u), int(vertex >> 11)), 0).xyz; }

void main() {
  vec3 here = place_of(uint(gl_VertexID)), sum = vec3(0.0);
  for (uint at = own_round.x; at < own_round.x + own_round.y; ++at) {
    uvec2 others = texelFetch(round, ivec2(int(at & 2047u), int(at >> 11)), 0).xy;
    sum += cross(place_of(others.x) - here, place_of(others.y) - here);
  }
  float size = length(sum);
  moved_normal = size > 0.0 ? sum / size : vec3(0.0);
  gl_Position = vec4(0.0);
}
