// Bones, arrows: capsules between two places, each with a radius at both ends.
layout(location = 0) in vec4 unit;  // of a ball of radius 1 about the axis z, and which end it belongs to
layout(location = 1) in vec4 from;  // and the radius there
layout(location = 2) in vec4 to;

void main() {
  vec3 way = to.xyz - from.xyz;
  float size = length(way);
  vec3 along = size > 1e-6 ? way / size : vec3(0.0, 0.0, 1.0);
  vec3 aside = abs(along.y) < 0.9 ? vec3(0.0, 1.0, 0.0) : vec3(1.0, 0.0, 0.0);
  vec3 x = normalize(cross(aside, along)), y = cross(along, x);
  // A cone's side leans by the difference of its radii.
  float lean = size > 1e-6 ? clamp((from.w - to.w) / size, -0.9, 0.9) : 0.0;
  vec3 u = unit.xyz;
  vec3 leaned = vec3(u.xy * sqrt(1.0 - lean * lean), u.z + lean * (1.0 - abs(u.z)));
  vec3 outwards = normalize(leaned.x * x + leaned.y * y + leaned.z * along);
  draw_at(mix(from.xyz, to.xyz, unit.w) + mix(from.w, to.w, unit.w) * outwards, outwards);
}
