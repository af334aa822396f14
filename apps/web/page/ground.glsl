layout(location = 0) in vec3 given_place;
uniform mat4 clip_of_world;
out vec3 place;
out vec3 normal;

void main() {
  place = given_place;
  normal = vec3(0.0, 1.0, 0.0);
  gl_Position = clip_of_world * vec4(place, 1.0);
}
