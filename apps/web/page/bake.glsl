// The base becomes what the fields make of it; what comes out is kept by transform feedback.
layout(location = 0) in vec3 base_place;
layout(location = 1) in vec3 base_normal;
out vec3 baked_place;
out vec3 baked_normal;

void main() {
  vec3 x = base_place, n = base_normal;
  deform(x, n);
  baked_place = x;
  baked_normal = n;
  gl_Position = vec4(0.0);
}
