// The base becomes what the fields make of it; what comes out is kept by transform feedback.
out vec3 baked_place;
out vec3 baked_normal;

void main() {
  baked_place = base_place;
  baked_normal = base_normal;
  deform(baked_place, baked_normal);
  gl_Position = vec4(0.0);
}
