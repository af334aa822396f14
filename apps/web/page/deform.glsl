// Takes a vertex and its normal through the fields that stand in a texture: of each field a texel
// (functions, kernel, has a polynomial), three of the polynomial's rows if it has one, and two a
// function (centre and 1 / radius; coefficient). Normals turn by the cofactors of the Jacobian.
uniform highp sampler2D fields; // 256 texels wide
uniform int field_count;

vec4 texel(int at) { return texelFetch(fields, ivec2(at & 255, at >> 8), 0); }

// psi(t) and psi'(t) / t, for t < 1.
vec2 wendland(int kernel, float t) {
  float u = 1.0 - t, u2 = u * u;
  if (kernel == 0) return vec2(u2, -2.0 * u / max(t, 1e-4));
  if (kernel == 1) return vec2(u2 * u2 * (4.0 * t + 1.0), -20.0 * u2 * u);
  if (kernel == 2)
    return vec2(u2 * u2 * u2 * ((35.0 * t + 18.0) * t + 3.0) / 3.0, -56.0 / 3.0 * u2 * u2 * u * (5.0 * t + 1.0));
  return vec2(u2 * u2 * u2 * u2 * (((32.0 * t + 25.0) * t + 8.0) * t + 1.0),
              -22.0 * u2 * u2 * u2 * u * ((16.0 * t + 7.0) * t + 1.0));
}

void deform(inout vec3 place, inout vec3 normal) {
  int at = 0;
  for (int field = 0; field < field_count; ++field) {
    vec4 head = texel(at++);
    vec3 s = vec3(0.0);
    mat3 jacobian = mat3(1.0);
    if (head.z > 0.0) {
      vec4 x = texel(at), y = texel(at + 1), z = texel(at + 2);
      at += 3;
      vec4 one = vec4(1.0, place);
      s = vec3(dot(x, one), dot(y, one), dot(z, one));
      jacobian += transpose(mat3(x.yzw, y.yzw, z.yzw));
    }
    int functions = int(head.x), kernel = int(head.y);
    for (int function = 0; function < functions; ++function, at += 2) {
      vec4 centre = texel(at);
      vec3 away = place - centre.xyz;
      float t = length(away) * centre.w;
      if (t >= 1.0) continue;
      vec3 coefficient = texel(at + 1).xyz;
      vec2 psi = wendland(kernel, t);
      s += coefficient * psi.x;
      jacobian += outerProduct(coefficient, away * (psi.y * centre.w * centre.w));
    }
    place += s;
    vec3 turned = mat3(cross(jacobian[1], jacobian[2]), cross(jacobian[2], jacobian[0]),
                       cross(jacobian[0], jacobian[1])) * normal;
    float size = length(turned);
    if (size > 0.0) normal = turned / size;
  }
}
