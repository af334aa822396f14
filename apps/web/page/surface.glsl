// A puppet's weights: the base moves by the sum of its terms, each of them a value times a vector.
layout(location = 0) in vec3 base_place;
layout(location = 4) in uvec2 own_terms;  // the first one, and how many
uniform highp sampler2D terms;            // the vector's number, and the value
uniform highp sampler2D vectors;          // 256 wide
out vec3 moved_place;

void main() {
  vec3 x = base_place;
  for (uint at = own_terms.x; at < own_terms.x + own_terms.y; ++at) {
    vec2 term = texelFetch(terms, ivec2(int(at & 2047u), int(at >> 11)), 0).xy;
    int vector = int(term.x);
    x += term.y * texelFetch(vectors, ivec2(vector & 255, vector >> 8), 0).xyz;
  }
  moved_place = x;
  gl_Position = vec4(0.0);
}
