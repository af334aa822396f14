// Key, fill and rim lights that go round with the camera, and a sky.
uniform vec3 eye, key, fill, rim;
uniform float gloss, opacity, rim_opacity;
uniform float grid, fade;   // of a ground
uniform float dark;         // of a shadow
uniform bool facets, unlit;
in vec3 place;
in vec3 normal;
out vec4 shown;

vec3 screen(vec3 linear) {
  vec3 soft = mix(linear, 0.8 + (linear - 0.8) / (1.0 + (linear - 0.8) / 0.2), greaterThan(linear, vec3(0.8)));
  return pow(max(soft, 0.0), vec3(1.0 / 2.2));
}
float line(float coordinate) {
  float width = max(0.0015, fwidth(coordinate));
  float off = abs(fract(coordinate / grid + 0.5) - 0.5) * grid;
  return clamp((width - off) / width + 0.5, 0.0, 1.0) * 0.0015 / width;
}
void main() {
  float near = clamp(1.25 - 1.25 * length(place.xz) / fade, 0.0, 1.0);
  if (dark > 0.0) { shown = vec4(0.0, 0.0, 0.0, dark * near); return; }
  if (grid > 0.0) {
    float drawn = max(line(place.x), line(place.z));
    shown = vec4(vec3(0.10), near * (0.05 + 0.30 * drawn));
    shown.rgb *= shown.a;
    return;
  }
  vec3 sight = normalize(eye - place);
  vec3 n = length(normal) > 0.0 ? normalize(normal) : sight;
  if (facets) n = normalize(cross(dFdx(place), dFdy(place)));
  if (dot(n, sight) < -0.3) n = -n; // nearly edge on, a smooth normal may lean away
  float across = 1.0 - clamp(dot(n, sight), 0.0, 1.0);
  float part = mix(opacity, rim_opacity, across * across * across);
  vec3 light = vec3(0.40 * (0.66 + 0.34 * n.y)) * (0.65 + 0.35 * smoothstep(0.0, 0.3, place.y));
  light += max(0.0, (dot(n, key) + 0.12) / 1.12) * vec3(1.42, 1.35, 1.25);
  light += max(0.0, (dot(n, fill) + 0.3) / 1.3) * vec3(0.22, 0.27, 0.34);
  light += across * across * max(0.0, (dot(n, rim) + 0.2) / 1.2) * vec3(0.62, 0.66, 0.72);
  float highlight = pow(max(0.0, dot(n, normalize(key + sight))), 32.0);
  vec3 own = own_colour();
  vec3 seen = unlit ? own : own * light + gloss * highlight * vec3(1.42, 1.35, 1.25);
  shown = vec4(screen(seen) * part, part);
}
